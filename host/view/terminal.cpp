#include "host/view/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "host/base/format.hpp"

namespace claray::view {
namespace {

struct Key {
    const char* bytes;
    const char* command;
};
constexpr Key keys[] = {{"\x1b[D", "orbit -5 0"},
                        {"\x1b[C", "orbit 5 0"},
                        {"\x1b[A", "orbit 0 5"},
                        {"\x1b[B", "orbit 0 -5"},
                        {"w", "fly 1 0 0"},
                        {"s", "fly -1 0 0"},
                        {"a", "fly 0 -1 0"},
                        {"d", "fly 0 1 0"},
                        {"q", "fly 0 0 -1"},
                        {"e", "fly 0 0 1"},
                        {"+", "exposure 0.5"},
                        {"-", "exposure -0.5"},
                        {"1", "show image"},
                        {"2", "show depth"},
                        {"3", "show normal"},
                        {"4", "show albedo"},
                        {"5", "show primitive"},
                        {"6", "show heat"},
                        {"h", "home"},
                        {"p", "pause"},
                        {"c", "camera"},
                        {"x", "quit"}};
constexpr const char* help = "arrows orbit, W A S D Q E fly, + - exposure, 1-6 show, H home, P pause, C camera, X quit";

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
        const std::string command = command_of_key(bytes.substr(0, length));
        bytes.erase(0, length);
        if (command.empty()) continue;
        try {
            told = view.run(parse_command(command));
        } catch (const Error& error) {
            told = error.what();
        }
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

std::string command_of_key(const std::string& key) {
    for (const Key& k : keys)
        if (key == k.bytes) return k.command;
    return {};
}

void run_in_terminal(View& view, const std::function<bool()>& goes_on) {
    const RawTerminal raw;
    Size size{0, 0};
    std::string told = help;
    bool complete = false;
    while (!view.ended() && goes_on()) {
        if (const Size now = terminal_size(); now != size) {
            size = now, complete = false;
            (void)view.run({"resize", {}, {float(now.columns), float(2 * std::max(now.rows - 1, 1u))}});
        }
        if (const std::string pressed = read_keys(complete ? 50 : 0); !pressed.empty()) {
            const std::string line = run_keys(view, pressed);
            told = line.empty() ? help : line;
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
