// Runs independent pieces of host work on all processors.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace claray {

/// Calls piece(0) to piece(count - 1) in any order, several at once; returns when all are done. They must not throw.
template <class Piece>
void in_parallel(std::size_t count, const Piece& piece) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i; (i = next++) < count;) piece(i);
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < std::thread::hardware_concurrency() && i < count; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

}  // namespace claray
