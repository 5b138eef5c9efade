#include "host/cli/ranks.hpp"

#include <unistd.h>

#include <csignal>
#include <cstring>
#include <optional>

#include "host/base/hash.hpp"
#include "host/cli/output/messages.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray::cli {
namespace {

std::optional<ranks::Session> the_session;
std::optional<ranks::Ranks> the_ranks;
std::string the_options;
std::optional<int> exit_code_of_rank_0;

/// All but the device, which belongs to a machine.
std::string options_of(int argc, char** argv) {
    std::string text;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--device") == 0)
            ++i;
        else if (std::strncmp(argv[i], "--device=", 9) != 0)
            text += (text.empty() ? "" : " ") + std::string(argv[i]);
    }
    return text;
}

/// Equal versions have equal kernels.
std::string program_version() {
    std::string kernels;
    for (const KernelSource& source : kernel_sources()) kernels += source.path + source.text;
    return CLARAY_VERSION " (kernels " + hash128(kernels).substr(0, 8) + ")";
}

std::string host_name() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

ranks::Hello own_hello() { return {program_version(), the_options, host_name(), {}}; }

}  // namespace

void start_ranks(int argc, char** argv) {
    if (argc < 2 || std::strcmp(argv[1], "render") != 0 || !ranks::started_together()) return;
    the_options = options_of(argc, argv);
    the_session.emplace();
    if (the_session->size() == 1)
        print_warning("the other ranks did not start in " + std::to_string(int(ranks::Session::seconds_to_start())) +
                      " s: rank 0 goes on alone");
}

ranks::Session* rank_session() { return the_session ? &*the_session : nullptr; }

bool is_other_rank() {
    return the_session ? the_session->rank() > 0 : ranks::started_together() && ranks::rank_by_launcher() > 0;
}

ranks::Ranks* meet_ranks() {
    if (!the_session) return nullptr;
    if (!the_ranks) the_ranks.emplace(*the_session, own_hello(), print_warning);
    return &*the_ranks;
}

/// Rank 0 decides what a signal means.
void serve_rank_0(const std::string& selectors, const std::string& compiler, const ranks::RenderFrame& render_frame) {
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
    exit_code_of_rank_0 =
        ranks::serve(*the_session, Device::open_several(selectors), own_hello(), compiler, render_frame);
}

int report_error(ErrorKind kind, const std::string& text) {
    if (!is_other_rank()) return print_error(kind, text);
    if (the_session) the_session->send(0, ranks::MessageKind::failure, to_bytes(ranks::failure_of(kind, text)));
    return int(kind);
}

int end_ranks(int exit_code) {
    if (!the_session) return exit_code;
    exit_code = exit_code_of_rank_0.value_or(exit_code);
    the_session->end(exit_code);
    return exit_code;
}

}  // namespace claray::cli
