// The server of the web page.
#pragma once

#include <httplib.h>

#include <string>

namespace claray::view {

/// A server of cpp-httplib that bounds what clients cost: requests that `refusal_of` refuses are answered before their
/// bodies are read, ranges are not made, and their connections end.
class LimitedServer : public httplib::Server {
public:
    /// `host`: that it listens at. `token`: that requests must have; empty: none.
    LimitedServer(std::string host, std::string token);

private:
    bool process_and_close_socket(socket_t socket) override;

    std::string host_, token_;
};

}  // namespace claray::view
