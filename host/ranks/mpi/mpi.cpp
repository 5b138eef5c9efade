// claray-mpi.so: what load_mpi loads.
#include "host/ranks/mpi/mpi.hpp"

#include <mpi.h>

#include <list>

namespace claray::ranks {
namespace {

class LinkedMpi final : public Mpi {
public:
    void start() override {
        int provided = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
        MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    }
    void end() override { MPI_Finalize(); }

    [[nodiscard]] int rank() const override {
        int rank = 0;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        return rank;
    }
    [[nodiscard]] int size() const override {
        int size = 1;
        MPI_Comm_size(MPI_COMM_WORLD, &size);
        return size;
    }

    [[nodiscard]] bool send(int to, int tag, std::shared_ptr<const std::string> bytes, std::size_t at,
                            std::size_t count) override {
        Sending& sending = sending_.emplace_back(Sending{std::move(bytes), MPI_REQUEST_NULL});
        const bool goes = MPI_Isend(sending.bytes->data() + at, int(count), MPI_BYTE, to, tag, MPI_COMM_WORLD,
                                    &sending.request) == MPI_SUCCESS;
        if (!goes) sending_.pop_back();
        return goes;
    }
    void forget_sent() override {
        sending_.remove_if([](Sending& sending) {
            int done = 0;
            return MPI_Test(&sending.request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0;
        });
    }
    [[nodiscard]] bool all_sent() const override { return sending_.empty(); }

    [[nodiscard]] std::optional<Arrival> arrival() override {
        int there = 0, bytes = 0;
        MPI_Status status;
        if (MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status) != MPI_SUCCESS || there == 0)
            return std::nullopt;
        MPI_Get_count(&status, MPI_BYTE, &bytes);
        return Arrival{status.MPI_SOURCE, status.MPI_TAG, std::size_t(bytes)};
    }
    [[nodiscard]] bool receive(const Arrival& arrival, char* to) override {
        return MPI_Recv(to, int(arrival.bytes), MPI_BYTE, arrival.from, arrival.tag, MPI_COMM_WORLD,
                        MPI_STATUS_IGNORE) == MPI_SUCCESS;
    }

private:
    struct Sending {
        std::shared_ptr<const std::string> bytes;
        MPI_Request request;
    };
    std::list<Sending> sending_;
};

}  // namespace
}  // namespace claray::ranks

extern "C" [[gnu::visibility("default")]] claray::ranks::Mpi* claray_mpi() {
    static auto* const mpi = new claray::ranks::LinkedMpi;  // a session ends after what is destroyed at the end
    return mpi;
}
