// Which process works on which case.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>

namespace claray::verify {

/// In memory that a process shares with those that it starts. Their numbers begin with 1.
class Claims {
public:
    /// Of `cases` > 0. Throws ErrorKind::user if the system has no memory for them.
    explicit Claims(std::size_t cases);
    ~Claims();
    Claims(const Claims&) = delete;
    Claims& operator=(const Claims&) = delete;

    /// Returns false if a process has the case already.
    [[nodiscard]] bool take(std::size_t i, unsigned process) {
        unsigned nobody = 0;
        return owners_[i].compare_exchange_strong(nobody, process);
    }
    void give_back(std::size_t i) { owners_[i] = 0; }
    /// 0: nobody's.
    [[nodiscard]] unsigned owner(std::size_t i) const { return owners_[i]; }

private:
    std::span<std::atomic<unsigned>> owners_;
};

}  // namespace claray::verify
