#include "host/ranks/session.hpp"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "host/base/hash.hpp"
#include "host/base/seconds_since.hpp"
#include "host/ranks/mpi/mpi.hpp"

namespace claray::ranks {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t largest_part = std::size_t(1) << 28;     // bytes of an MPI message, whose size is an int
constexpr std::chrono::microseconds between_looks{200};        // for messages, while some come
constexpr std::chrono::microseconds between_rare_looks{2000};  // each takes some 10 us of a processor
constexpr double seconds_of_attention = 1e-3;                  // after a message
constexpr std::chrono::seconds time_to_end{10};
constexpr double seconds_of_silence = 5;  // before it is said that a start takes long

/// A tag says the kind of a message, whether it goes on to other ranks, and whether a further part follows.
constexpr int more_parts = 1, along_tree = 2, kinds = 4;

/// A thread that waits in MPI cannot be ended.
[[noreturn]] void end_at_once(int exit_code) {
    std::fflush(nullptr);
    ::_exit(exit_code);
}

/// Messages that only say that a rank is alive have no checksum.
Message message_in(int from, int tag, std::string bytes) {
    const auto kind = MessageKind(tag / kinds);
    if (kind == MessageKind::alive) return {from, bytes.empty() ? kind : MessageKind::damaged, {}};
    std::optional<std::string> content = unsealed(std::move(bytes));
    return content ? Message{from, kind, std::move(*content)} : Message{from, MessageKind::damaged, {}};
}

/// The lowest rank that is not below it in the binomial tree of `pass_on`: rank 6 gets messages of rank 2.
int parent_of(int rank) { return rank - int(std::bit_floor(unsigned(rank))); }

}  // namespace

struct Session::State {
    struct Outgoing {
        int to;
        int tag;
        std::shared_ptr<const std::string> bytes;
    };
    struct Peer {
        Clock::time_point heard = Clock::now();
        std::string parts;  // of a message
        bool is_lost = false, has_left = false;
    };

    void run();
    void start();
    [[nodiscard]] bool send_all();
    void send_parts(const Outgoing& message);
    [[nodiscard]] bool receive_one();
    void deliver(Message message);
    void pass_on(int tag, const std::string& part);
    void keep_alive();
    void lose(int rank);
    void finish();
    [[nodiscard]] bool is_lost(int rank) const { return peers[std::size_t(rank)].is_lost; }

    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Outgoing> outgoing;
    std::deque<Message> incoming;
    std::mutex handler_mutex;
    std::function<void(const Message&)> handler;
    bool has_started = false, is_alone = false, ends = false, has_ended = false, any_lost = false;
    bool tree_is_broken = false;  // a rank is gone that would pass messages on
    int exit_code = 0;

    // Of the thread.
    Mpi& mpi = load_mpi();
    int rank = 0, size = 1;
    std::vector<Peer> peers;
    Clock::time_point last_alive = Clock::now(), last_message;
    std::thread thread;
};

void Session::State::run() {
    start();
    for (;;) {
        bool busy = send_all();
        while (receive_one()) busy = true;  // all, before a rank counts as lost
        keep_alive();
        if (busy) last_message = Clock::now();
        const bool attends = seconds_since(last_message) < seconds_of_attention;
        std::unique_lock lock(mutex);
        if (ends && outgoing.empty()) break;
        if (!busy)
            changed.wait_for(lock, attends ? between_looks : between_rare_looks,
                             [&] { return ends || !outgoing.empty(); });
    }
    finish();
    const std::lock_guard lock(mutex);
    has_ended = true;
    changed.notify_all();
}

void Session::State::start() {
    mpi.start();
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return !is_alone; });  // else it is too late
    rank = mpi.rank(), size = mpi.size();
    peers.resize(std::size_t(size));
    has_started = true;
    changed.notify_all();
}

bool Session::State::send_all() {
    std::deque<Outgoing> messages;
    {
        const std::lock_guard lock(mutex);
        std::swap(messages, outgoing);
    }
    for (const Outgoing& message : messages) send_parts(message);
    mpi.forget_sent();
    return !messages.empty();
}

void Session::State::send_parts(const Outgoing& message) {
    std::size_t at = 0;
    do {
        const std::size_t bytes = std::min(largest_part, message.bytes->size() - at);
        const int more = at + bytes < message.bytes->size() ? more_parts : 0;
        if (is_lost(message.to)) return;
        if (!mpi.send(message.to, message.tag | more, message.bytes, at, bytes)) return lose(message.to);
        at += bytes;
    } while (at < message.bytes->size());
}

bool Session::State::receive_one() {
    const std::optional<Mpi::Arrival> arrival = mpi.arrival();
    if (!arrival) return false;
    const auto [from, tag, bytes] = *arrival;
    std::string part(bytes, '\0');
    if (!mpi.receive(*arrival, part.data())) {
        lose(from);
        return true;
    }
    Peer& peer = peers[std::size_t(from)];
    peer.heard = Clock::now();
    if (tag & along_tree && rank > 0 && from == parent_of(rank)) pass_on(tag, part);
    peer.parts += part;
    if (tag & more_parts && part.size() == largest_part) return true;
    Message message = message_in(from, tag, std::exchange(peer.parts, {}));
    if ((message.kind == MessageKind::quit && from == 0) || message.kind == MessageKind::failure) {
        peer.has_left = true;
        const std::lock_guard lock(mutex);
        tree_is_broken = true;
    }
    if (message.kind != MessageKind::alive && !peer.is_lost) deliver(std::move(message));
    return true;
}

/// Rank r passes to r + 1, r + 2, r + 4 ... from the first power of two above r on: a binomial tree.
void Session::State::pass_on(int tag, const std::string& part) {
    const auto shared = std::make_shared<const std::string>(part);
    int step = 1;
    while (step <= rank) step *= 2;
    for (; rank + step < size; step *= 2) {
        (void)mpi.send(rank + step, tag, shared, 0, shared->size());
    }
}

void Session::State::deliver(Message message) {
    const std::lock_guard handler_lock(handler_mutex);
    if (handler) return handler(message);
    const std::lock_guard lock(mutex);
    incoming.push_back(std::move(message));
    changed.notify_all();
}

/// Rank 0 watches all others, and they watch rank 0.
void Session::State::keep_alive() {
    const double limit = seconds_until_lost();
    const bool is_due = seconds_since(last_alive) > limit / 10;
    if (is_due) last_alive = Clock::now();
    const int watched = rank == 0 ? size : 1;
    for (int other = rank == 0 ? 1 : 0; other < watched; ++other) {
        const Peer& peer = peers[std::size_t(other)];
        if (peer.is_lost || peer.has_left) continue;
        if (is_due) send_parts({other, int(MessageKind::alive) * kinds, std::make_shared<const std::string>()});
        if (seconds_since(peer.heard) > limit) lose(other);
    }
}

void Session::State::lose(int other) {
    Peer& peer = peers[std::size_t(other)];
    if (peer.is_lost) return;
    peer.is_lost = true;
    {
        const std::lock_guard lock(mutex);
        any_lost = tree_is_broken = true;
    }
    deliver({other, MessageKind::failure, {}});
}

/// Mpi::end waits for all ranks, so it is called only while none is lost.
void Session::State::finish() {
    const Clock::time_point begin = Clock::now();
    while (!mpi.all_sent() && seconds_since(begin) < 2) {
        (void)send_all();
        (void)receive_one();
        std::this_thread::sleep_for(between_looks);
    }
    if (!any_lost) mpi.end();
}

Session::Session() : state_(std::make_unique<State>()) {
    state_->thread = std::thread([state = state_.get()] { state->run(); });
    std::unique_lock lock(state_->mutex);
    const auto starts_within = [&](double seconds) {
        return state_->changed.wait_for(lock, std::chrono::duration<double>(seconds),
                                        [&] { return state_->has_started; });
    };
    if (starts_within(seconds_of_silence)) return;
    if (rank_by_launcher() == 0) std::fprintf(stderr, "claray: waiting for the other ranks to start\n");
    if (starts_within(seconds_to_start() - seconds_of_silence)) return;
    if (rank_by_launcher() > 0) {
        std::fprintf(stderr, "claray: rank %d ends: MPI did not start in time\n", rank_by_launcher());
        end_at_once(1);
    }
    state_->is_alone = true;
}

Session::~Session() { end(0); }

int Session::rank() const { return state_->rank; }
int Session::size() const { return state_->size; }

void Session::send(int to, MessageKind kind, std::string bytes) {
    const std::lock_guard lock(state_->mutex);
    state_->outgoing.push_back({to, int(kind) * kinds, std::make_shared<const std::string>(sealed(std::move(bytes)))});
    state_->changed.notify_all();
}

void Session::broadcast(MessageKind kind, std::string bytes) {
    const auto shared = std::make_shared<const std::string>(sealed(std::move(bytes)));
    const std::lock_guard lock(state_->mutex);
    const bool direct = state_->tree_is_broken;
    for (int to = 1; to < state_->size; to = direct ? to + 1 : 2 * to)
        state_->outgoing.push_back({to, int(kind) * kinds | (direct ? 0 : along_tree), shared});
    state_->changed.notify_all();
}

void Session::handle(std::function<void(const Message&)> handler) {
    const std::lock_guard lock(state_->handler_mutex);
    state_->handler = std::move(handler);
}

std::optional<Message> Session::receive(std::chrono::milliseconds most) {
    std::unique_lock lock(state_->mutex);
    if (!state_->changed.wait_for(lock, most, [&] { return !state_->incoming.empty(); })) return std::nullopt;
    Message message = std::move(state_->incoming.front());
    state_->incoming.pop_front();
    return message;
}

void Session::end(int exit_code) {
    if (!state_->thread.joinable()) return;
    if (state_->is_alone) end_at_once(exit_code);
    handle({});
    if (state_->rank == 0)
        for (int other = 1; other < state_->size; ++other) send(other, MessageKind::quit, std::to_string(exit_code));
    std::unique_lock lock(state_->mutex);
    state_->ends = true;
    state_->changed.notify_all();
    const bool ended = state_->changed.wait_for(lock, time_to_end, [&] { return state_->has_ended; });
    if (!ended || state_->any_lost) end_at_once(exit_code);
    lock.unlock();
    state_->thread.join();
}

}  // namespace claray::ranks

namespace claray::ranks {
namespace {

/// Of Open MPI; of MPICH, Intel MPI and Slurm's PMI; the first that is set.
int value_of(std::initializer_list<const char*> variables, int otherwise) {
    for (const char* variable : variables)
        if (const char* value = std::getenv(variable); value != nullptr && *value != '\0') return std::atoi(value);
    return otherwise;
}

}  // namespace

std::string sealed(std::string bytes) {
    bytes += hash128(bytes);
    return bytes;
}

std::optional<std::string> unsealed(std::string bytes) {
    const std::size_t size = hash128("").size();
    if (bytes.size() < size) return std::nullopt;
    const std::string checksum = bytes.substr(bytes.size() - size);
    bytes.resize(bytes.size() - size);
    if (hash128(bytes) != checksum) return std::nullopt;
    return bytes;
}

bool started_together() { return value_of({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}, 1) > 1; }
int rank_by_launcher() { return value_of({"OMPI_COMM_WORLD_RANK", "PMI_RANK"}, 0); }

double Session::seconds_to_start() { return std::max(60., 2 * seconds_until_lost()); }

double Session::seconds_until_lost() {
    const char* value = std::getenv("CLARAY_RANK_SECONDS");
    const double seconds = value == nullptr ? 0 : std::atof(value);
    return seconds > 0 ? seconds : 30;
}

}  // namespace claray::ranks
