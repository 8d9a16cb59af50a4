// Memory of one compile. Its stages make a few hundred arrays that all die together: they are cut from one block, which
// each thread keeps for its next compile. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tyndall::rg::stages {

/// What is still free of the block at hand. Each thread has its own.
struct ScratchSpace {
    std::byte* at = nullptr;
    std::byte* end = nullptr;
};
extern constinit thread_local ScratchSpace scratch_space;

/// A new block where the one at hand is too small; ends the program where there is no memory, as operator new does.
[[nodiscard]] void* allocate_scratch_block(std::size_t bytes);

[[nodiscard]] inline void* allocate_scratch(std::size_t bytes) {
    constexpr std::size_t alignment = alignof(std::max_align_t);
    ScratchSpace& space = scratch_space;
    bytes = (bytes + alignment - 1) / alignment * alignment;
    if (static_cast<std::size_t>(space.end - space.at) < bytes) {
        return allocate_scratch_block(bytes);
    }
    void* const taken = space.at;
    space.at += bytes;
    return taken;
}

/// Everything taken while it lives is free again when it ends. Scopes nest; each entry into the stages opens one.
class ScratchScope {
public:
    ScratchScope();
    ~ScratchScope();
    ScratchScope(const ScratchScope&) = delete;
    ScratchScope& operator=(const ScratchScope&) = delete;

private:
    ScratchSpace saved_;
    std::size_t saved_blocks_;
};

template <typename T>
struct ScratchAllocator {
    using value_type = T;
    static_assert(alignof(T) <= alignof(std::max_align_t));
    ScratchAllocator() = default;
    template <typename U>
    explicit(false) ScratchAllocator(const ScratchAllocator<U>& /*other*/) {}
    [[nodiscard]] T* allocate(std::size_t count) { return static_cast<T*>(allocate_scratch(count * sizeof(T))); }
    void deallocate(T* /*block*/, std::size_t /*count*/) {}
    friend bool operator==(const ScratchAllocator&, const ScratchAllocator&) = default;
};

/// An array that does not outlive the ScratchScope in which it grows. The address sanitiser sees each array by itself.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TYNDALL_SCRATCH_ON_HEAP 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(TYNDALL_SCRATCH_ON_HEAP)
template <typename T>
using Scratch = std::vector<T>;
#else
template <typename T>
using Scratch = std::vector<T, ScratchAllocator<T>>;
#endif

} // namespace tyndall::rg::stages
