// claray-verify: the cases of `claray verify` as a program that needs an OpenCL loader only. Exit codes are those of
// claray (docs/reliability.md): 0: all cases hold, 1: a file, 2: the command line, 3: the device, or a case fails.
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "claray/error.hpp"
#include "claray/verify.hpp"
#include "host/base/file.hpp"
#include "host/base/format.hpp"
#include "host/base/seconds_since.hpp"
#include "host/verify/apart/run_apart.hpp"
#include "host/verify/probes/reduce.hpp"
#include "host/verify/reports.hpp"

namespace claray::verify {
namespace {

constexpr const char* usage = R"(usage: claray-verify [OPTION...]: tests an OpenCL device and its driver
  --list            print the cases
  --case NAME       run only this case; may be repeated
  --device WHICH    cpu, gpu, a number or a part of the name
  --full            run the full number of trials: minutes on a GPU, hours on a few CPU cores
  --seed NUMBER     seed of random rays and meshes [1]
  --limit SECONDS   time after which a case is ended and fails [600; with --full none]
  --tap FILE, --junit FILE, --json FILE
                    write the results in this form
  --reduce FOLDER   write a kernel and a C program for each probe that fails, or each of --case
Exit codes: 0: all cases hold, 1: a file cannot be written, 2: wrong command line, 3: a case or the device fails
)";

struct Options {
    VerifyOptions how;
    std::vector<std::string> cases;
    std::string device;
    std::filesystem::path tap, junit, json, reduce;
    double limit = -1;
    bool list = false, help = false;
};

template <class Number>
Number number_of(const std::string& option, const std::string& text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !(number >= 0))
        throw Error(ErrorKind::usage, option + " does not accept '" + text + "'", "give a number");
    return number;
}

void set_option(Options& o, const std::string& option, const std::string& value) {
    if (option == "--case")
        o.cases.push_back(value);
    else if (option == "--device")
        o.device = value;
    else if (option == "--seed")
        o.how.seed = number_of<std::uint64_t>(option, value);
    else if (option == "--limit")
        o.limit = number_of<double>(option, value);
    else if (option == "--tap")
        o.tap = value;
    else if (option == "--junit")
        o.junit = value;
    else if (option == "--json")
        o.json = value;
    else if (option == "--reduce")
        o.reduce = value;
    else
        throw Error(ErrorKind::usage, "unknown option '" + option + "'", "see --help");
}

Options parse(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const std::string option = argv[i];
        if (option == "--list")
            o.list = true;
        else if (option == "--help")
            o.help = true;
        else if (option == "--full" || option == "--quick")  // as the commands say that repeat a case
            o.how.effort = option == "--full" ? Effort::full : Effort::quick;
        else if (i + 1 < argc && *argv[i + 1] != '\0')
            set_option(o, option, argv[++i]);
        else
            set_option(o, option, {}), throw Error(ErrorKind::usage, option + " needs a value", "see --help");
    }
    if (o.limit < 0) o.limit = o.how.effort == Effort::full ? 0 : quick_limit;
    check_verify_cases(o.cases);
    return o;
}

void say(const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

/// A known fault counts here, since the driver is tested and not claray.
VerifyResult without_excuses(VerifyResult result) {
    for (VerifyCheck& check : result.checks) check.known = false;
    const std::string from = "claray verify ";
    if (result.command.starts_with(from)) result.command.replace(0, from.size(), "claray-verify ");
    return result;
}

void print(const VerifyResult& result) {
    say(printed("%-18s %s %7.2f s", result.name.c_str(), result.holds() ? "holds" : "FAILS", result.seconds));
    for (const auto& [name, value] : result.facts) say("    " + name + ": " + value);
    if (result.holds()) return;
    for (const VerifyCheck& c : result.checks)
        if (!c.holds())
            say("    " + c.what + printed(": %g of at most %g ", c.worst, c.bar) + c.unit + " in " +
                std::to_string(c.tried));
    for (const std::string& failure : result.failures) say("    " + failure);
    say("    repeat: " + result.command);
}

/// Runs cases apart; returns the device.
DeviceInfo run(const Options& o, const std::vector<std::string>& names,
               const std::function<void(const VerifyResult&)>& report) {
    DeviceInfo device;
    const auto opened = [&](const DeviceInfo& info) { device = info; };
    const auto open = [&] { return Device::open(o.device); };
    run_verify_cases_apart(open, names, o.how, o.limit, opened,
                           [&](const VerifyResult& result) { report(without_excuses(result)); });
    return device;
}

int reduce(const Options& o) {
    std::string number;  // of the device
    const auto run_some = [&](const std::vector<std::string>& names, const auto& report) {
        number = std::to_string(run(o, names, report).index);
    };
    for (const std::string& name : probes_to_write(o.cases, run_some, say))
        say(write_probe(o.reduce, name) + ' ' + number);
    return 0;
}

int test(const Options& o) {
    for (const std::filesystem::path& path : {o.tap, o.junit, o.json})
        if (!path.empty()) check_file_writable(path);
    std::vector<std::string> names = o.cases;
    if (names.empty())
        for (const VerifyCase& c : verify_cases()) names.push_back(c.name);
    std::vector<VerifyResult> results;
    std::size_t failed = 0;
    const auto begin = std::chrono::steady_clock::now();
    const DeviceInfo device = run(o, names, [&](const VerifyResult& result) {
        print(result);
        failed += !result.holds();
        results.push_back(result);
    });
    const double seconds = seconds_since(begin);
    if (!o.tap.empty()) write_file(o.tap, tap_of(results));
    if (!o.junit.empty()) write_file(o.junit, junit_of(device, results));
    if (!o.json.empty()) write_file(o.json, json_of(device, o.how, results, seconds));
    say(printed("%zu of %zu cases hold in %.1f s: ", results.size() - failed, results.size(), seconds) + device.name +
        ", driver " + device.driver);
    return failed == 0 ? 0 : int(ErrorKind::device);
}

int run_program(int argc, char** argv) {
    const Options o = parse(argc, argv);
    if (o.help) return std::fputs(usage, stdout), 0;
    if (!o.list) return o.reduce.empty() ? test(o) : reduce(o);
    for (const VerifyCase& c : verify_cases()) say(printed("%-18s %-10s ", c.name.c_str(), c.family.c_str()) + c.what);
    return 0;
}

}  // namespace
}  // namespace claray::verify

int main(int argc, char** argv) {
    try {
        return claray::verify::run_program(argc, argv);
    } catch (const claray::Error& error) {
        std::fprintf(stderr, "claray-verify: %s\n", error.what());
        return int(error.kind());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "claray-verify: %s\n", error.what());
        return int(claray::ErrorKind::user);
    }
}
