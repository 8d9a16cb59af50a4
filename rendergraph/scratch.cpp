// Blocks of scratch memory.
// In: sizes. Out: bytes of the calling thread. Invariant: when the outermost scope has ended there is one block, as
// large as all that it needed.
#include "rendergraph/scratch.hpp"

#include <algorithm>
#include <memory>

namespace tyndall::rg::stages {
namespace {

constexpr std::size_t first_block_bytes = std::size_t{64} << 10U;

struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size = 0;
};
/// In the order in which they were needed; scratch_space lies in the last.
thread_local std::vector<Block> blocks;

/// Its bytes are not touched before they are used.
void add_block(std::size_t size) {
    blocks.push_back({std::unique_ptr<std::byte[]>(new std::byte[size]), size});
}
} // namespace

constinit thread_local ScratchSpace scratch_space;

void* allocate_scratch_block(std::size_t bytes) {
    std::size_t size = std::max(first_block_bytes, bytes);
    if (!blocks.empty()) {
        size = std::max(size, 2 * blocks.back().size);
    }
    add_block(size);
    std::byte* const begin = blocks.back().bytes.get();
    scratch_space = {begin + bytes, begin + size};
    return begin;
}

ScratchScope::ScratchScope() : saved_(scratch_space), saved_blocks_(blocks.size()) {}

ScratchScope::~ScratchScope() {
    if (blocks.size() == saved_blocks_) {
        scratch_space = saved_;
        return;
    }
    // All of the last block was taken since the scope began. What lay in the blocks before may still be in use, unless
    // nothing did when it began.
    const bool all_free = saved_blocks_ == 0 || (saved_blocks_ == 1 && saved_.at == blocks.front().bytes.get());
    if (all_free) {
        std::size_t total = 0;
        for (const Block& block : blocks) {
            total += block.size;
        }
        blocks.clear();
        add_block(total);
    }
    const Block& last = blocks.back();
    scratch_space = {last.bytes.get(), last.bytes.get() + last.size};
}

} // namespace tyndall::rg::stages
