#include "host/verify/apart/claims.hpp"

#include <sys/mman.h>

#include <memory>

#include "claray/error.hpp"

namespace claray::verify {

Claims::Claims(std::size_t cases) {
    static_assert(std::atomic<unsigned>::is_always_lock_free, "processes share no locks");
    const std::size_t bytes = cases * sizeof(std::atomic<unsigned>);
    void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw Error(ErrorKind::user, "no memory for processes to share", "end other programs");
    owners_ = {static_cast<std::atomic<unsigned>*>(memory), cases};
    std::uninitialized_value_construct(owners_.begin(), owners_.end());
}

Claims::~Claims() { ::munmap(owners_.data(), owners_.size_bytes()); }

}  // namespace claray::verify
