// A connection to the web page whose requests have limits.
#pragma once

#include <httplib.h>

#include <array>
#include <atomic>
#include <chrono>

namespace claray::view {

/// The connections of cpp-httplib read lines and headers of any length into memory. This one ends a request that takes
/// too many bytes or too long to arrive. All waits end soon after the server stops.
class Connection : public httplib::Stream {
public:
    /// `listening` is the server's own socket, INVALID_SOCKET after it has stopped. Closes `socket` when destroyed.
    Connection(socket_t socket, const std::atomic<socket_t>& listening) : socket_(socket), listening_(listening) {}
    ~Connection() override;
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    /// Waits for the first byte of a request; false if none comes in time.
    [[nodiscard]] bool has_request(std::chrono::seconds idle);
    /// So many bytes of a body follow the headers, which were read.
    void expect(std::size_t bytes);
    /// Sends the end of the answer, and lets the client read it although not all that it sent was read: a socket that
    /// is closed with bytes to read takes the answer with it (RFC 9112, section 9.6).
    void linger();

    [[nodiscard]] bool is_readable() const override;
    /// False as soon as the client has closed its side.
    [[nodiscard]] bool is_writable() const override;
    ssize_t read(char* to, std::size_t size) override;
    ssize_t write(const char* from, std::size_t size) override;
    void get_remote_ip_and_port(std::string&, int&) const override {}
    void get_local_ip_and_port(std::string&, int&) const override {}
    [[nodiscard]] socket_t socket() const override { return socket_; }

private:
    using Clock = std::chrono::steady_clock;
    /// Returns the events of poll(2) that came in time; 0: none.
    [[nodiscard]] int wait(int events, Clock::time_point until) const;
    [[nodiscard]] bool receive(Clock::time_point until);

    socket_t socket_;
    const std::atomic<socket_t>& listening_;
    std::array<char, 4096> buffer_{};
    std::size_t begin_ = 0, end_ = 0;  // of what was received and not read yet
    std::size_t left_ = 0;             // bytes of the request
    Clock::time_point until_;          // when the request must be complete
};

}  // namespace claray::view
