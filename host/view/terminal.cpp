#include "host/view/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "host/base/format.hpp"
#include "host/view/input.hpp"

namespace claray::view {
namespace {

/// Keys arrive at once and unseen; the alternative screen hides what was there. Both end with this object.
class RawTerminal {
public:
    RawTerminal() {
        if (::isatty(STDIN_FILENO) == 0 || ::isatty(STDOUT_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &before_) != 0)
            throw Error(ErrorKind::user, "--terminal: standard input and output are not a terminal",
                        "leave --terminal out, or use --script");
        termios raw = before_;
        raw.c_lflag &= ~tcflag_t(ICANON | ECHO);
        raw.c_cc[VMIN] = 0, raw.c_cc[VTIME] = 0;
        ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
        std::fputs("\x1b[?1049h\x1b[?25l", stdout);
    }
    ~RawTerminal() {
        std::fputs("\x1b[0m\x1b[?25h\x1b[?1049l", stdout);
        std::fflush(stdout);
        ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    }
    RawTerminal(const RawTerminal&) = delete;
    RawTerminal& operator=(const RawTerminal&) = delete;

private:
    termios before_{};
};

struct Size {
    unsigned columns, rows;
    bool operator==(const Size&) const = default;
};

Size terminal_size() {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
    return {size.ws_col, size.ws_row};
}

/// Returns the keys pressed, waiting for one for at most `milliseconds`.
std::string read_keys(int milliseconds) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char bytes[64];
    if (::poll(&input, 1, milliseconds) <= 0) return {};
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    return count > 0 ? std::string(bytes, std::size_t(count)) : std::string();
}

std::string run_keys(View& view, std::string bytes) {
    std::string told;
    while (!bytes.empty()) {
        const std::size_t length = bytes.starts_with("\x1b[") ? std::min<std::size_t>(3, bytes.size()) : 1;
        const std::string command = command_of_key(key_of_bytes(bytes.substr(0, length)));
        bytes.erase(0, length);
        if (!command.empty()) told = answer(view, command).line;
    }
    return told;
}

}  // namespace

std::string half_blocks(const Frame& frame) {
    std::string text = "\x1b[H";
    const auto color = [&](unsigned x, unsigned y) { return &frame.pixels[4 * (std::size_t(y) * frame.width + x)]; };
    for (unsigned y = 0; y + 1 < frame.height; y += 2) {
        for (unsigned x = 0; x < frame.width; ++x) {
            const std::uint8_t *above = color(x, y), *below = color(x, y + 1);
            text += printed("\x1b[38;2;%d;%d;%d;48;2;%d;%d;%dm\xe2\x96\x80", above[0], above[1], above[2], below[0],
                            below[1], below[2]);
        }
        text += "\x1b[0m\r\n";
    }
    return text;
}

std::string key_of_bytes(const std::string& bytes) {
    if (bytes == "\x1b[A") return "ArrowUp";
    if (bytes == "\x1b[B") return "ArrowDown";
    if (bytes == "\x1b[C") return "ArrowRight";
    if (bytes == "\x1b[D") return "ArrowLeft";
    return bytes;
}

void run_in_terminal(View& view, const std::function<bool()>& goes_on) {
    const RawTerminal raw;
    Size size{0, 0};
    std::string told = key_help;
    bool complete = false;
    while (!view.ended() && goes_on()) {
        if (const Size now = terminal_size(); now != size) {
            size = now, complete = false;
            (void)view.run({"resize", {}, {float(now.columns), float(2 * std::max(now.rows - 1, 1u))}});
        }
        if (const std::string pressed = read_keys(complete ? 50 : 0); !pressed.empty()) {
            const std::string line = run_keys(view, pressed);
            told = line.empty() ? key_help : line;
            complete = false;
        }
        if (complete) continue;
        const Frame& frame = view.next_frame();
        complete = frame.complete;
        const std::string status = printed("%u spp  ", frame.spp) + told;
        const std::string text =
            half_blocks(frame) + "\x1b[K" + status.substr(0, size.columns > 1 ? size.columns - 1 : 1);
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
    }
}

}  // namespace claray::view
