#include "engine/queue_choice.hpp"

#include <array>
#include <utility>

namespace tyndall::engine {
namespace {

/// Queue flags that a family must and must not have.
struct Wish {
    VkQueueFlags with;
    VkQueueFlags without;
};

class Families {
public:
    explicit Families(std::span<const QueueFamilyInfo> families) : families_(families), used_(families.size(), 0) {}

    /// A free queue for the first wish that can be met.
    bool take(rg::QueueKind kind, std::span<const Wish> wishes) {
        for (const Wish& wish : wishes) {
            for (std::size_t i = 0; i < families_.size(); ++i) {
                const QueueFamilyInfo& family = families_[i];
                const bool fits = (family.flags & wish.with) == wish.with && (family.flags & wish.without) == 0;
                if (fits && used_[i] < family.count) {
                    queues_.push_back({kind, family.family, used_[i]++});
                    return true;
                }
            }
        }
        return false;
    }
    [[nodiscard]] std::vector<QueueChoice> queues() && { return std::move(queues_); }

private:
    std::span<const QueueFamilyInfo> families_;
    std::vector<std::uint32_t> used_;
    std::vector<QueueChoice> queues_;
};

} // namespace

std::vector<QueueChoice> choose_queues(std::span<const QueueFamilyInfo> families) {
    constexpr VkQueueFlags graphics = VK_QUEUE_GRAPHICS_BIT;
    constexpr VkQueueFlags compute = VK_QUEUE_COMPUTE_BIT;
    constexpr VkQueueFlags transfer = VK_QUEUE_TRANSFER_BIT;
    Families free(families);
    if (!free.take(rg::QueueKind::graphics, std::array{Wish{graphics | compute, 0}})) {
        return {};
    }
    free.take(rg::QueueKind::compute, std::array{Wish{compute, graphics}, Wish{compute, 0}});
    // Families for video also announce transfer; that they have neither graphics nor compute is what counts. Graphics
    // and compute imply transfer, whether or not the flag is set.
    free.take(rg::QueueKind::transfer,
              std::array{Wish{transfer, graphics | compute}, Wish{compute, graphics}, Wish{graphics, 0}});
    return std::move(free).queues();
}

} // namespace tyndall::engine
