// The view as a web page: pushes frames, takes commands.
#pragma once

#include <functional>
#include <string>

#include "host/view/view.hpp"

namespace claray::view {

struct WebConfig {
    std::string host = "127.0.0.1";  ///< address to listen at; other computers see it only if told
    int port = 8080;                 ///< 0: any that is free
    std::function<bool()> goes_on;   ///< asked between frames
    std::function<void(const std::string& url)> ready = {};
};

/// Serves the view until it ends or `goes_on` returns false. No web site can reach the view through its visitors, and
/// no client can take much memory: see `refusal_of` and LimitedServer. Throws ErrorKind::user if the port cannot be
/// had.
void serve(View& view, const WebConfig& config);

}  // namespace claray::view
