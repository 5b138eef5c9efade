// The calls of MPI. They stand in a library of their own, which only a process loads that a launcher started: MPI
// brings some thirty libraries.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace claray::ranks {

/// All calls come from one thread.
class Mpi {
public:
    struct Arrival {
        int from, tag;
        std::size_t bytes;
    };
    virtual ~Mpi() = default;

    virtual void start() = 0;
    /// Waits for all ranks.
    virtual void end() = 0;
    [[nodiscard]] virtual int rank() const = 0;
    [[nodiscard]] virtual int size() const = 0;

    /// Sends `count` bytes, at most 2^31 - 1, from `at` on. Does not wait; keeps `bytes` until they are sent. Returns
    /// false if the rank cannot be reached.
    [[nodiscard]] virtual bool send(int to, int tag, std::shared_ptr<const std::string> bytes, std::size_t at,
                                    std::size_t count) = 0;
    /// Frees what is sent.
    virtual void forget_sent() = 0;
    /// Whether nothing is left that `forget_sent` did not free.
    [[nodiscard]] virtual bool all_sent() const = 0;
    /// The next message, if there is one.
    [[nodiscard]] virtual std::optional<Arrival> arrival() = 0;
    /// Returns false if the message is lost. `to`: memory for all of its bytes.
    [[nodiscard]] virtual bool receive(const Arrival& arrival, char* to) = 0;
};

/// Throws ErrorKind::user if this claray has no MPI, or if MPI is not installed.
[[nodiscard]] Mpi& load_mpi();

}  // namespace claray::ranks
