// The view as a web page: pushes frames, takes commands.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "host/view/view.hpp"

namespace claray::view {

struct WebConfig {
    /// Address to listen at. If other computers can reach it, every request must have a token, which `ready` receives.
    std::string host = "127.0.0.1";
    int port = 8080;                ///< 0: any that is free
    bool framed = false;            ///< pages of other sites may show it in a frame; every request must have a token
    std::function<bool()> goes_on;  ///< asked between frames
    std::function<void(const std::string& url)> ready = {};
    /// Loads another scene, of a file that was dropped on the page. Empty: files are refused.
    std::function<View(const std::filesystem::path&)> open = {};
    /// A command line, and the text of a job file, that render what is seen. Empty: there is none.
    std::function<std::string(const View&)> command_line = {}, job = {};
};

/// Serves the view until it ends or `goes_on` returns false. No web site can reach the view through its visitors, and
/// no client can take much memory: see `refusal_of` and LimitedServer. Throws ErrorKind::user if the port cannot be
/// had.
void serve(View& view, const WebConfig& config);

}  // namespace claray::view
