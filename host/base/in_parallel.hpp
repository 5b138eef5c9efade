// Runs independent pieces of host work on all processors.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace claray {

/// Calls piece(0) to piece(count - 1) in any order, several at once; returns when all are done. After an exception no
/// further piece begins, and the first one is thrown again.
template <class Piece>
void in_parallel(std::size_t count, const Piece& piece) {
    std::atomic<std::size_t> next{0};
    std::mutex failing;
    std::exception_ptr failure;
    const auto work = [&] {
        try {
            for (std::size_t i; (i = next++) < count;) piece(i);
        } catch (...) {
            const std::lock_guard lock(failing);
            if (!failure) failure = std::current_exception();
            next = count;
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < std::thread::hardware_concurrency() && i < count; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace claray
