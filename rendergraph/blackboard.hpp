// Typed structs by which features hand each other handles without knowing each other.
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace tyndall::rg {

/// One value per type. Works without run-time type information: a type's key is the address of a static of its own.
class Blackboard {
public:
    /// Puts a value, or replaces the one of that type.
    template <typename T>
    T& put(T value) {
        auto holder = std::make_unique<Holder<T>>(std::move(value));
        T& reference = holder->value;
        for (Entry& entry : entries_) {
            if (entry.key == key<T>()) {
                entry.holder = std::move(holder);
                return reference;
            }
        }
        entries_.push_back({key<T>(), std::move(holder)});
        return reference;
    }
    /// Null when nobody put one.
    template <typename T>
    [[nodiscard]] T* find() {
        for (Entry& entry : entries_) {
            if (entry.key == key<T>()) {
                return &static_cast<Holder<T>*>(entry.holder.get())->value;
            }
        }
        return nullptr;
    }
    void clear() { entries_.clear(); }

private:
    struct HolderBase {
        virtual ~HolderBase() = default;
    };
    template <typename T>
    struct Holder final : HolderBase {
        explicit Holder(T v) : value(std::move(v)) {}
        T value;
    };
    struct Entry {
        const void* key;
        std::unique_ptr<HolderBase> holder;
    };
    template <typename T>
    [[nodiscard]] static const void* key() {
        static constexpr char address = 0;
        return &address;
    }
    std::vector<Entry> entries_;
};

} // namespace tyndall::rg
