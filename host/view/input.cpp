#include "host/view/input.hpp"

namespace claray::view {
namespace {

constexpr KeyRow keys[] = {{"ArrowLeft", "orbit -5 0"},
                           {"ArrowRight", "orbit 5 0"},
                           {"ArrowUp", "orbit 0 5"},
                           {"ArrowDown", "orbit 0 -5"},
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
                           {"7", "show error"},
                           {"n", "denoise on"},
                           {"m", "denoise off"},
                           {"l", "play"},
                           {"h", "home"},
                           {"p", "pause"},
                           {" ", "pause"},
                           {"t", "next"},
                           {"k", "save view.png"},
                           {"c", "camera"},
                           {"x", "quit"}};

}  // namespace

std::span<const KeyRow> key_rows() { return keys; }

std::string command_of_key(const std::string& key) {
    for (const KeyRow& row : keys)
        if (key == row.key) return row.command;
    return {};
}

}  // namespace claray::view
