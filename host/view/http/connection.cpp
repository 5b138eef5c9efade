#include "host/view/http/connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace claray::view {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t longest_request = 65536;  // bytes, until its headers are read
constexpr auto longest_arrival = seconds(10), longest_write = seconds(5);
constexpr std::size_t most_discarded = 1 << 20;  // bytes
constexpr auto longest_lingering = seconds(1);
constexpr int slice = 100;  // milliseconds

}  // namespace

Connection::~Connection() { ::close(socket_); }

int Connection::wait(int events, Clock::time_point until) const {
    for (;;) {
        const auto left = std::chrono::duration_cast<milliseconds>(until - Clock::now()).count();
        pollfd poll{socket_, short(events), 0};
        if (::poll(&poll, 1, int(std::clamp<long>(left, 0, slice))) > 0) return poll.revents;
        if (left <= 0 || listening_ == INVALID_SOCKET) return 0;
    }
}

bool Connection::receive(Clock::time_point until) {
    if ((wait(POLLIN, until) & POLLIN) == 0) return false;
    const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    begin_ = 0, end_ = std::size_t(std::max<ssize_t>(count, 0));
    return count > 0;
}

bool Connection::has_request(std::chrono::seconds idle) {
    if (begin_ == end_ && !receive(Clock::now() + idle)) return false;
    left_ = longest_request, until_ = Clock::now() + longest_arrival;
    return true;
}

void Connection::expect(std::size_t bytes) { left_ = bytes; }

void Connection::linger() {
    ::shutdown(socket_, SHUT_WR);
    const auto until = Clock::now() + longest_lingering;
    for (std::size_t discarded = 0; discarded < most_discarded && receive(until);) discarded += end_;
}

bool Connection::is_readable() const { return begin_ < end_ || (wait(POLLIN, Clock::now()) & POLLIN) != 0; }

bool Connection::is_writable() const {
    const int events = wait(POLLOUT | POLLRDHUP, Clock::now() + longest_write);
    return (events & POLLOUT) != 0 && (events & (POLLRDHUP | POLLHUP | POLLERR)) == 0;
}

ssize_t Connection::read(char* to, std::size_t size) {
    if (left_ == 0 || (begin_ == end_ && !receive(until_))) return -1;
    const std::size_t count = std::min({size, end_ - begin_, left_});
    std::copy_n(buffer_.data() + begin_, count, to);
    begin_ += count, left_ -= count;
    return ssize_t(count);
}

ssize_t Connection::write(const char* from, std::size_t size) {
    if ((wait(POLLOUT, Clock::now() + longest_write) & POLLOUT) == 0) return -1;
    return ::send(socket_, from, size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace claray::view
