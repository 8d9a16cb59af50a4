// One pass over the words. A module lists decorations before types, types before the variables that have them, and
// variables before functions ("Logical Layout of a Module"), so each instruction finds what it needs already read.
#include "rendergraph/shader_bindings.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <tuple>

namespace tyndall::rg {
namespace {

// Numbers of the SPIR-V specification, version 1.6, "Binary Form".
constexpr std::uint32_t magic = 0x07230203;
constexpr std::size_t header_words = 5;

namespace op {
constexpr std::uint32_t type_image = 25;
constexpr std::uint32_t type_sampler = 26;
constexpr std::uint32_t type_sampled_image = 27;
constexpr std::uint32_t type_array = 28;
constexpr std::uint32_t type_runtime_array = 29;
constexpr std::uint32_t type_struct = 30;
constexpr std::uint32_t type_pointer = 32;
constexpr std::uint32_t function_call = 57;
constexpr std::uint32_t variable = 59;
constexpr std::uint32_t image_texel_pointer = 60;
constexpr std::uint32_t load = 61;
constexpr std::uint32_t store = 62;
constexpr std::uint32_t copy_memory = 63;
constexpr std::uint32_t access_chain = 65;
constexpr std::uint32_t in_bounds_access_chain = 66;
constexpr std::uint32_t ptr_access_chain = 67;
constexpr std::uint32_t array_length = 68;
constexpr std::uint32_t in_bounds_ptr_access_chain = 70;
constexpr std::uint32_t decorate = 71;
constexpr std::uint32_t member_decorate = 72;
constexpr std::uint32_t copy_object = 83;
constexpr std::uint32_t type_acceleration_structure = 5341;
} // namespace op

namespace decoration {
constexpr std::uint32_t buffer_block = 3;
constexpr std::uint32_t non_writable = 24;
constexpr std::uint32_t non_readable = 25;
constexpr std::uint32_t binding = 33;
constexpr std::uint32_t descriptor_set = 34;
} // namespace decoration

namespace storage_class {
constexpr std::uint32_t uniform = 2;
constexpr std::uint32_t storage_buffer = 12;
} // namespace storage_class

namespace dim {
constexpr std::uint32_t buffer = 5;
constexpr std::uint32_t subpass_data = 6;
} // namespace dim

/// Words of an instruction that name a pointer it goes through: [first, end), cut at the instruction's own end.
struct PointerOperands {
    std::uint32_t code;
    std::uint32_t first;
    std::uint32_t end;
};
constexpr PointerOperands pointer_operands[] = {
    {op::function_call, 4, ~0U},
    {op::image_texel_pointer, 3, 4},
    {op::load, 3, 4},
    {op::store, 1, 2},
    {op::copy_memory, 1, 3},
    {op::access_chain, 3, 4},
    {op::in_bounds_access_chain, 3, 4},
    {op::ptr_access_chain, 3, 4},
    {op::array_length, 3, 4},
    {op::in_bounds_ptr_access_chain, 3, 4},
    {op::copy_object, 3, 4},
};

struct Decorations {
    std::uint32_t set = 0;
    std::optional<std::uint32_t> binding;
    bool buffer_block = false;
    bool non_writable = false;
    bool non_readable = false;
    std::set<std::uint32_t> non_writable_members;
    std::set<std::uint32_t> non_readable_members;
};

/// Of arrays and pointers: what they hold.
struct Type {
    std::optional<VkDescriptorType> descriptor; ///< of an image, a sampler, an acceleration structure
    std::uint32_t block = 0;                    ///< id of a structure
    std::size_t members = 0;                    ///< of the structure
};

struct Variable {
    ReflectedBinding reflected;
    bool used = false;
};

VkDescriptorType image_descriptor(std::uint32_t dimensions, bool storage) {
    switch (dimensions) {
    case dim::buffer:
        return storage ? VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case dim::subpass_data: return VK_DESCRIPTOR_TYPE_INPUT_ATTACHMENT;
    default: return storage ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
    }
}

class Module {
public:
    /// One instruction, its first word included. False where it has too few words or a type that makes no sense.
    [[nodiscard]] bool read(std::uint32_t code, std::span<const std::uint32_t> words) {
        switch (code) {
        case op::decorate: return words.size() >= 3 && decorate(words);
        case op::member_decorate: return words.size() >= 4 && decorate_member(words);
        case op::type_image: return words.size() >= 9 && add_image(words);
        case op::type_sampler: return words.size() >= 2 && add_type(words[1], VK_DESCRIPTOR_TYPE_SAMPLER);
        case op::type_acceleration_structure:
            return words.size() >= 2 && add_type(words[1], VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR);
        case op::type_sampled_image: return words.size() >= 3 && add_sampled_image(words);
        case op::type_array:
        case op::type_runtime_array: return words.size() >= 3 && add_holder(words[1], words[2]);
        case op::type_struct: return words.size() >= 2 && add_struct(words);
        case op::type_pointer: return words.size() >= 4 && add_holder(words[1], words[3]);
        case op::variable: return words.size() >= 4 && add_variable(words);
        default: mark_used(code, words); return true;
        }
    }

    [[nodiscard]] std::vector<ReflectedBinding> used() const {
        std::vector<ReflectedBinding> out;
        for (const auto& [id, variable] : variables_) {
            if (variable.used) {
                merge_bindings(out, {&variable.reflected, 1});
            }
        }
        return out;
    }

private:
    bool decorate(std::span<const std::uint32_t> words) {
        Decorations& target = decorations_[words[1]];
        switch (words[2]) {
        case decoration::buffer_block: target.buffer_block = true; return true;
        case decoration::non_writable: target.non_writable = true; return true;
        case decoration::non_readable: target.non_readable = true; return true;
        case decoration::binding:
        case decoration::descriptor_set: break;
        default: return true;
        }
        if (words.size() < 4) {
            return false;
        }
        if (words[2] == decoration::binding) {
            target.binding = words[3];
        } else {
            target.set = words[3];
        }
        return true;
    }

    bool decorate_member(std::span<const std::uint32_t> words) {
        if (words[3] == decoration::non_writable) {
            decorations_[words[1]].non_writable_members.insert(words[2]);
        } else if (words[3] == decoration::non_readable) {
            decorations_[words[1]].non_readable_members.insert(words[2]);
        }
        return true;
    }

    bool add_type(std::uint32_t id, VkDescriptorType descriptor) {
        types_[id] = {.descriptor = descriptor};
        return true;
    }

    bool add_image(std::span<const std::uint32_t> words) {
        constexpr std::uint32_t without_sampler = 2;
        return add_type(words[1], image_descriptor(words[3], words[7] == without_sampler));
    }

    bool add_sampled_image(std::span<const std::uint32_t> words) {
        const auto image = types_.find(words[2]);
        const bool texels =
            image != types_.end() && image->second.descriptor == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
        return add_type(words[1],
                        texels ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
    }

    bool add_struct(std::span<const std::uint32_t> words) {
        types_[words[1]] = {.block = words[1], .members = words.size() - 2};
        return true;
    }

    /// An array or a pointer. What it holds may be a number or a matrix, of which nothing is kept.
    bool add_holder(std::uint32_t id, std::uint32_t held) {
        const auto found = types_.find(held);
        types_[id] = found == types_.end() ? Type{} : Type(found->second);
        return true;
    }

    bool add_variable(std::span<const std::uint32_t> words) {
        const Decorations& own = decorations_[words[2]];
        if (!own.binding) {
            return true; // no descriptor: an input, an output, push constants, shared or private memory
        }
        const Type type = types_[words[1]];
        const Decorations& block = decorations_[type.block];
        std::optional<VkDescriptorType> descriptor = type.descriptor;
        if (type.block != 0 && words[3] == storage_class::storage_buffer) {
            descriptor = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        } else if (type.block != 0 && words[3] == storage_class::uniform) {
            // Before version 1.3 a storage buffer is a uniform whose block is a buffer block.
            descriptor = block.buffer_block ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        }
        if (!descriptor) {
            return false;
        }
        const bool storage = *descriptor == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER ||
                             *descriptor == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE ||
                             *descriptor == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
        const auto all = [&](const std::set<std::uint32_t>& members) {
            return type.members > 0 && members.size() == type.members;
        };
        variables_[words[2]].reflected = {
            .set = own.set,
            .binding = *own.binding,
            .type = *descriptor,
            .may_read = !storage || !(own.non_readable || all(block.non_readable_members)),
            .may_write = storage && !(own.non_writable || all(block.non_writable_members))};
        return true;
    }

    void mark_used(std::uint32_t code, std::span<const std::uint32_t> words) {
        const auto* found = std::find_if(std::begin(pointer_operands), std::end(pointer_operands),
                                         [&](const PointerOperands& row) { return row.code == code; });
        if (found == std::end(pointer_operands)) {
            return;
        }
        for (std::size_t i = found->first; i < std::min<std::size_t>(found->end, words.size()); ++i) {
            if (const auto variable = variables_.find(words[i]); variable != variables_.end()) {
                variable->second.used = true;
            }
        }
    }

    std::map<std::uint32_t, Decorations> decorations_;
    std::map<std::uint32_t, Type> types_;
    std::map<std::uint32_t, Variable> variables_; ///< those with a binding
};

} // namespace

tl::expected<std::vector<ReflectedBinding>, std::string> reflect_bindings(std::span<const std::uint32_t> spirv) {
    if (spirv.size() < header_words || spirv.front() != magic) {
        return tl::unexpected<std::string>("The words do not begin as a SPIR-V module of this machine's byte order");
    }
    Module read;
    for (std::size_t at = header_words; at < spirv.size();) {
        const std::size_t count = spirv[at] >> 16U;
        if (count == 0 || count > spirv.size() - at) {
            return tl::unexpected("The instruction at word " + std::to_string(at) + " has a length that cannot be");
        }
        if (!read.read(spirv[at] & 0xFFFFU, spirv.subspan(at, count))) {
            return tl::unexpected("The instruction at word " + std::to_string(at) + " makes no sense");
        }
        at += count;
    }
    return read.used();
}

void merge_bindings(std::vector<ReflectedBinding>& bindings, std::span<const ReflectedBinding> more) {
    const auto place = [](const ReflectedBinding& at) { return std::tuple(at.set, at.binding, at.type); };
    for (const ReflectedBinding& added : more) {
        const auto found = std::ranges::lower_bound(bindings, place(added), {}, place);
        if (found == bindings.end() || place(*found) != place(added)) {
            bindings.insert(found, added);
        } else {
            found->may_read |= added.may_read;
            found->may_write |= added.may_write;
        }
    }
}

bool checks_bindings(bool asked) {
#ifdef NDEBUG
    return asked;
#else
    static_cast<void>(asked);
    return true;
#endif
}

} // namespace tyndall::rg
