// The command line of `claray compile`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "claray/renderer.hpp"

namespace claray::cli {

struct CompileOptions {
    std::string device, effects;
    RenderConfig config;
    bool quiet = false;
    bool background =
        false;  ///< started by a render, whose programs it reads: see host/render/kernels/background_compiler.hpp
    bool serves = false;  ///< compiles what standard input asks for
};

void add_compile_options(CLI::App& command, CompileOptions& options);

}  // namespace claray::cli
