// claray attest: what a device and its driver hold, as a file; and many such files as a page.
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "claray/program/compiling.hpp"
#include "claray/renderer.hpp"
#include "host/base/file.hpp"
#include "host/base/folders.hpp"
#include "host/base/format.hpp"
#include "host/base/process/process.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/attestation.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/verify_lines.hpp"
#include "host/scene/bytes.hpp"
#include "host/verify/apart/child.hpp"
#include "host/verify/apart/run_apart.hpp"

namespace claray::cli {
namespace {

struct AttestOptions {
    CaseOptions run;
    std::vector<std::filesystem::path> files;
    bool page = false;
};

/// What a child process does and sends; why not, if it throws, dies or takes longer than `limit` seconds.
std::string answer_of(const std::function<std::string()>& work, double limit, std::string& why_not) {
    verify::Child child([&](const verify::Child::Send& send) {
        try {
            send('+' + work());
        } catch (const std::exception& error) {
            send('-' + std::string(error.what()));
        }
    });
    using Clock = verify::Child::Clock;
    const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit));
    std::string answer;
    const verify::Child::Heard heard = child.hear(answer, until);
    const std::string how = child.ended(until);
    why_not.clear();
    if (heard == verify::Child::Heard::nothing)
        why_not = printed("killed after %g s without an end", limit);
    else if (heard == verify::Child::Heard::end)
        why_not = "the driver ended the process " + how;
    else if (answer[0] == '-')
        why_not = answer.substr(1, answer.find('\n') - 1);
    return why_not.empty() ? answer.substr(1) : "";
}

std::string opencl_c_of(const std::string& selector, double limit) {
    std::string why_not;
    return answer_of(
        [&] {
            const Device device = Device::open(selector);
            const auto devices = device.context().getInfo<CL_CONTEXT_DEVICES>();
            return devices.at(0).getInfo<CL_DEVICE_OPENCL_C_VERSION>();
        },
        limit, why_not);
}

/// With empty caches, claray's own and those of the drivers that have one.
FirstPicture first_picture(const std::string& scene, const std::string& selector, double limit) {
    FirstPicture picture{scene};
    const auto caches = scratch_folder();
    const std::string answer = answer_of(
        [&] {
            for (const char* cache : {"CLARAY_CACHE_DIR", "CUDA_CACHE_PATH", "MESA_SHADER_CACHE_DIR"})
                ::setenv(cache, caches->c_str(), 1);
            RenderConfig config;
            config.width = config.height = 256, config.spp = 1, config.compiler = this_program();
            Renderer renderer(Device::open(selector), *builtin_scene(scene), config);
            renderer.render();
            ByteWriter writer;
            writer.add(renderer.statistics().first_pixel_seconds, compile_statistics().milliseconds / 1e3);
            return writer.take();
        },
        limit, picture.failure);
    if (picture.failure.empty()) ByteReader(answer).get(picture.seconds, picture.compile_seconds);
    return picture;
}

void print_page(const std::vector<std::filesystem::path>& files) {
    if (files.empty())
        throw Error(ErrorKind::usage, "--page needs files", "name files that 'claray attest FILE' wrote");
    std::vector<Attestation> attestations;
    for (const std::filesystem::path& file : files) attestations.push_back(read_attestation(file));
    std::fputs(attestation_page(std::move(attestations)).c_str(), stdout);
}

void attest(const AttestOptions& options) {
    if (options.page) return print_page(options.files);
    if (options.files.size() > 1)
        throw Error(ErrorKind::usage, "more than one file is given", "name one, or print a page of them by --page");
    const std::filesystem::path file = options.files.empty() ? "-" : options.files.front();
    const bool to_output = file == "-";
    if (!to_output) check_outputs({{"FILE", file}});
    check_verify_cases(options.run.cases);
    const Verified verified = run_cases(
        options.run,
        [&](const DeviceInfo& device) {
            if (!to_output) print_head(device);
        },
        [&](const VerifyResult& result) {
            if (!to_output) print_result(result);
        });
    std::vector<FirstPicture> pictures;
    const double limit = options.run.limit.value_or(verify::quick_limit);  // also with --full
    const std::string selector = std::to_string(verified.device.index);
    for (const char* scene : {"cornell", "spheres"}) pictures.push_back(first_picture(scene, selector, limit));
    const std::string text =
        attestation_text(verified, options.run.verify_options(), opencl_c_of(selector, limit), pictures);
    if (to_output)
        std::fputs(text.c_str(), stdout);
    else
        write_file(file, text);
    std::fflush(stdout);
    refuse_failed(verified);
}

}  // namespace

void add_attest_command(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("attest", "Run verify and write what this device and driver hold as a file; make a page");
    command->footer(
        "The file is JSON: the device, its driver, the date, and all figures. The exit code is 3 if a case fails.\n"
        "Examples:\n"
        "  claray attest driver.json --device gpu\n"
        "  claray attest --page docs/drivers/*.json");
    auto o = std::make_shared<AttestOptions>();
    command->add_option("files", o->files, "File to write [standard output]; with --page files to read");
    command->add_flag("--page", o->page, "Print a page in Markdown of files that this command wrote");
    add_case_options(*command, o->run);
    command->callback([&action, command, o] {
        refuse_contradicting_case_options(*command);
        refuse_both(*command, "--page",
                    {"--quick", "--full", "--case", "--limit", "--seed", "--no-times", "--threads", "--device"},
                    "--page runs no case");
        action = [o] { attest(*o); };
    });
}

}  // namespace claray::cli
