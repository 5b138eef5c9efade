// Counts the kernels that are compiled from source, for those who asked to be told (claray/program/compiling.hpp).
#pragma once

#include "claray/program/compiling.hpp"

namespace claray {

/// Kernels that are known to be missing. They count as compiled at the latest when the scope ends.
class Compiling {
public:
    explicit Compiling(unsigned kernels);
    ~Compiling();
    Compiling(const Compiling&) = delete;
    Compiling& operator=(const Compiling&) = delete;

    /// One of them is compiled. May be called by several threads.
    void one_done();

private:
    unsigned left_;  // guarded as the sums of all threads are
};

}  // namespace claray
