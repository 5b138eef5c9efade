// The server of the web page.
#pragma once

#include <httplib.h>

#include "host/view/http/http.hpp"

namespace claray::view {

/// A server of cpp-httplib that bounds what clients cost: requests that `refusal_of` refuses are answered before their
/// bodies are read, ranges are not made, and their connections end.
class LimitedServer : public httplib::Server {
public:
    explicit LimitedServer(HttpAccess access);

private:
    bool process_and_close_socket(socket_t socket) override;

    HttpAccess access_;
};

}  // namespace claray::view
