// claray render under mpirun.
#pragma once

#include <vector>

#include "claray/device.hpp"
#include "host/ranks/frames.hpp"
#include "host/ranks/serve.hpp"

namespace claray::cli {

/// Starts the session if mpirun started several processes for `claray render`. Throws as ranks::Session.
void start_ranks(int argc, char** argv);
/// Null if this process is alone.
[[nodiscard]] ranks::Session* rank_session();
/// Whether this process leaves outputs and messages to rank 0.
[[nodiscard]] bool is_other_rank();
/// Rank 0: waits for the other ranks; null if this process is alone.
[[nodiscard]] ranks::Ranks* meet_ranks();
/// Other ranks: render for rank 0 until it quits.
void serve_rank_0(const std::string& devices, const std::string& compiler, const ranks::RenderFrame& render_frame);

/// Prints an error on rank 0; other ranks tell rank 0. Returns the exit code.
int report_error(ErrorKind kind, const std::string& text);
/// Ends the session, if there is one. Returns the exit code, which is rank 0's.
int end_ranks(int exit_code);

}  // namespace claray::cli
