#include "host/cli/output/attestation.hpp"

#include <algorithm>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>

#include "host/base/file.hpp"
#include "host/base/format.hpp"
#include "host/base/message.hpp"
#include "host/cli/output/table.hpp"
#include "host/compute/programs/kernel_sources.hpp"
#include "host/verify/apart/run_apart.hpp"
#include "host/verify/reports.hpp"

namespace claray::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format = "claray attestation";
constexpr const char* known_fault = "known fault of this driver";  // a fact of probes
constexpr int version = 1;                                         // of the format; a reader refuses later ones

constexpr const char* attested_extensions[] = {
    "cl_khr_fp64",      "cl_khr_fp16",       "cl_khr_int64_base_atomics", "cl_khr_int64_extended_atomics",
    "cl_khr_subgroups", "cl_khr_il_program", "cl_khr_3d_image_writes",    "cl_khr_integer_dot_product"};

std::string date_now() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    ::gmtime_r(&now, &utc);
    char text[32];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

/// How a case is repeated follows from its name.
Json as_json(const VerifyResult& result) {
    Json json = Json::parse(verify::json_of(result));
    for (const char* name : {"seed", "command"}) json.erase(name);
    return json;
}

Json as_json(const FirstPicture& picture) {
    if (!picture.failure.empty()) return {{"scene", picture.scene}, {"failure", picture.failure}};
    return {{"scene", picture.scene}, {"seconds", picture.seconds}, {"compile_seconds", picture.compile_seconds}};
}

std::string in_one_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why,
                         const std::string& remedy = "make it again by 'claray attest FILE'") {
    throw Error(ErrorKind::user, "'" + file.string() + "' is no attestation of a device: " + why, remedy);
}

/// A member of an object. `T` is a type of JSON's values.
template <class T>
T member(const std::filesystem::path& file, const Json& object, const char* name) {
    const auto found = object.is_object() ? object.find(name) : object.end();
    if (object.is_object() && found != object.end()) try {
            return found->template get<T>();
        } catch (const Json::exception&) {  // of another type
        }
    refuse(file, "it has no valid '" + std::string(name) + "'");
}

const Json& list(const std::filesystem::path& file, const Json& object, const char* name) {
    const auto found = object.is_object() ? object.find(name) : object.end();
    if (!object.is_object() || found == object.end() || !found->is_array())
        refuse(file, "it has no valid '" + std::string(name) + "'");
    return *found;
}

/// The first figure above its limit, unless the case did not end, and the first failure.
std::string reason_of(const std::filesystem::path& file, const Json& one) {
    std::string reason;
    for (const Json& check : list(file, one, "checks")) {
        if (member<bool>(file, check, "holds") || !reason.empty()) continue;
        const auto what = member<std::string>(file, check, "what");
        if (what == verify::unended_figure) continue;
        const auto worst = check.find("worst");
        reason = what + ": " +
                 (worst != check.end() && worst->is_number() ? number(worst->get<double>()) : "not a number") + " > " +
                 number(member<double>(file, check, "bar")) + " " + member<std::string>(file, check, "unit");
    }
    const Json& failures = list(file, one, "failures");
    if (failures.empty()) return reason;
    if (!failures[0].is_string()) refuse(file, "it has no valid 'failures'");
    return (reason.empty() ? "" : reason + "; ") + failures[0].get<std::string>();
}

FirstPicture picture_from(const std::filesystem::path& file, const Json& json) {
    FirstPicture picture;
    picture.scene = member<std::string>(file, json, "scene");
    if (json.contains("failure")) {
        picture.failure = member<std::string>(file, json, "failure");
        return picture;
    }
    picture.seconds = member<double>(file, json, "seconds");
    picture.compile_seconds = member<double>(file, json, "compile_seconds");
    return picture;
}

/// As text in a cell of a table: names come from drivers.
std::string cell(const std::string& text, std::size_t most = 160) {
    std::string out;
    for (const char c : one_line(text, most))
        out += c == '|' ? "\\|" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

std::string row(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& text : cells) line += " " + text + " |";
    return line + "\n";
}

std::string table_head(const std::vector<std::string>& names) {
    return row(names) + row(std::vector<std::string>(names.size(), "---"));
}

std::string first_picture_of(const Attestation& of, const std::string& scene) {
    for (const FirstPicture& picture : of.first_pictures)
        if (picture.scene == scene) return picture.failure.empty() ? fixed(picture.seconds, 2) : "fails";
    return "";
}

std::string devices_table(const std::vector<Attestation>& all) {
    std::vector<std::string> scenes;
    for (const Attestation& a : all)
        for (const FirstPicture& picture : a.first_pictures)
            if (std::ranges::find(scenes, picture.scene) == scenes.end()) scenes.push_back(picture.scene);
    std::vector<std::string> head = {"name",    "platform", "device", "driver", "OpenCL C",   "units",
                                     "float64", "date",     "claray", "effort", "cases hold", "seconds"};
    for (const std::string& scene : scenes) head.push_back("first picture of `" + scene + "`, s");
    std::string text = table_head(head);
    for (const Attestation& a : all) {
        const auto held = std::ranges::count_if(a.cases, [](const AttestedCase& c) { return c.holds; });
        std::vector<std::string> cells = {"[" + cell(a.name) + "](" + cell(a.name) + ".json)",
                                          cell(a.platform),
                                          cell(a.device) + " (" + cell(a.type) + ")",
                                          cell(a.driver),
                                          cell(a.opencl_c),
                                          std::to_string(a.compute_units),
                                          a.fp64 ? "yes" : "no",
                                          cell(a.date.substr(0, 10)),
                                          cell(a.claray) + " (kernels " + cell(a.kernels.substr(0, 8)) + ")",
                                          cell(a.effort),
                                          std::to_string(held) + " of " + std::to_string(a.cases.size()),
                                          fixed(a.seconds, 0)};
        for (const std::string& scene : scenes) cells.push_back(first_picture_of(a, scene));
        text += row(cells);
    }
    return text;
}

/// In the order of this version's cases; others follow.
std::vector<std::string> cases_of(const std::vector<Attestation>& all) {
    std::vector<std::string> names;
    for (const VerifyCase& c : verify_cases()) names.push_back(c.name);
    const std::size_t known = names.size();
    for (const Attestation& a : all)
        for (const AttestedCase& c : a.cases)
            if (std::ranges::find(names, c.name) == names.end()) names.push_back(c.name);
    std::sort(names.begin() + std::ptrdiff_t(known), names.end());
    return names;
}

const AttestedCase* case_of(const Attestation& a, const std::string& name) {
    const auto found = std::ranges::find(a.cases, name, &AttestedCase::name);
    return found == a.cases.end() ? nullptr : &*found;
}

const char* word_of(const AttestedCase* c) {
    if (c == nullptr) return "not run";
    if (c->known) return "known fault";
    return c->holds ? "holds" : "**fails**";
}

std::string cases_table(const std::vector<Attestation>& all) {
    std::vector<std::string> head = {"case"};
    for (const Attestation& a : all) head.push_back(cell(a.name));
    std::string text = table_head(head);
    for (const std::string& name : cases_of(all)) {
        std::vector<std::string> cells = {"`" + cell(name) + "`"};
        for (const Attestation& a : all) {
            const AttestedCase* const c = case_of(a, name);
            cells.push_back(word_of(c));
        }
        text += row(cells);
    }
    return text;
}

std::string failures_table(const std::vector<Attestation>& all) {
    std::string text = table_head({"name", "case", "what is wrong"});
    for (const Attestation& a : all)
        for (const AttestedCase& c : a.cases)
            if (!c.reason.empty()) text += row({cell(a.name), "`" + cell(c.name) + "`", cell(c.reason)});
    for (const Attestation& a : all)
        for (const FirstPicture& picture : a.first_pictures)
            if (!picture.failure.empty())
                text += row({cell(a.name), "first picture of `" + cell(picture.scene) + "`", cell(picture.failure)});
    return text;
}

}  // namespace

std::string attestation_text(const Verified& verified, const VerifyOptions& options, const std::string& opencl_c,
                             const std::vector<FirstPicture>& pictures) {
    const DeviceInfo& device = verified.device;
    Json extensions = Json::array(), firsts = Json::array();
    for (const char* extension : attested_extensions)
        if (device.has(extension)) extensions.push_back(extension);
    for (const FirstPicture& picture : pictures) firsts.push_back(as_json(picture));
    const Json head = {{"format", format},
                       {"version", version},
                       {"claray", CLARAY_VERSION},
                       {"kernels", hash_of_kernel_sources()},
                       {"platform", device.platform},
                       {"device", device.name},
                       {"driver", device.driver},
                       {"opencl", device.version},
                       {"opencl_c", opencl_c},
                       {"type", to_string(device.type)},
                       {"compute_units", device.compute_units},
                       {"memory_bytes", device.memory},
                       {"local_memory_bytes", device.local_memory},
                       {"max_work_group", device.max_work_group},
                       {"exact_divide", device.exact_divide},
                       {"extensions", extensions},
                       {"date", date_now()},
                       {"effort", options.effort == Effort::full ? "full" : "quick"},
                       {"seed", options.seed},
                       {"seconds", verified.seconds},
                       {"first_pictures", firsts}};
    std::string text = "{\n";
    for (const auto& [name, value] : head.items()) text += in_one_line(name) + ": " + in_one_line(value) + ",\n";
    text += "\"cases\": [";
    for (const VerifyResult& result : verified.results)
        text += (&result == &verified.results.front() ? "\n" : ",\n") + in_one_line(as_json(result));
    return text + "\n]}\n";
}

Attestation read_attestation(const std::filesystem::path& file) {
    const std::string text = read_file(file, "give a file that 'claray attest FILE' wrote");
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::parse_error& error) {
        refuse(file, error.byte > text.size() ? printed("it ends too early, after %zu bytes", text.size())
                                              : printed("its byte %zu is not JSON", error.byte));
    }
    if (!json.is_object() || json.value("format", Json()) != format) refuse(file, "claray did not write it");
    const int its_version = member<int>(file, json, "version");
    if (its_version != version)
        refuse(file, printed("it has version %d, and this program reads %d", its_version, version),
               "use the claray that wrote it");
    const auto text_of = [&](const char* name) { return member<std::string>(file, json, name); };
    Attestation a;
    a.name = file.stem().string();
    a.claray = text_of("claray"), a.kernels = text_of("kernels"), a.platform = text_of("platform");
    a.device = text_of("device"), a.driver = text_of("driver"), a.opencl = text_of("opencl");
    a.opencl_c = text_of("opencl_c"), a.type = text_of("type"), a.date = text_of("date"), a.effort = text_of("effort");
    a.compute_units = member<unsigned>(file, json, "compute_units");
    a.seconds = member<double>(file, json, "seconds");
    const auto extensions = member<std::vector<std::string>>(file, json, "extensions");
    a.fp64 = std::ranges::find(extensions, "cl_khr_fp64") != extensions.end();
    for (const Json& picture : list(file, json, "first_pictures"))
        a.first_pictures.push_back(picture_from(file, picture));
    for (const Json& one : list(file, json, "cases")) {
        AttestedCase c = {member<std::string>(file, one, "case"), member<bool>(file, one, "holds")};
        const auto facts = one.find("facts");
        c.known = c.holds && facts != one.end() && facts->is_object() && facts->contains(known_fault);
        if (c.known)
            c.reason = member<std::string>(file, *facts, known_fault);
        else if (!c.holds)
            c.reason = reason_of(file, one);
        a.cases.push_back(std::move(c));
    }
    return a;
}

std::string attestation_page(std::vector<Attestation> all) {
    std::ranges::sort(all, {}, &Attestation::name);
    const auto fails = [](const Attestation& a) {
        return std::ranges::any_of(a.cases, [](const AttestedCase& c) { return !c.reason.empty(); }) ||
               std::ranges::any_of(a.first_pictures, [](const FirstPicture& p) { return !p.failure.empty(); });
    };
    std::string text =
        "# Drivers\n\n"
        "`claray attest --page docs/drivers/*.json` makes this page from the results of `claray verify` on each "
        "driver.\n"
        "[Faults of drivers](faults.md) tells what claray does about them, and how to repeat them.\n"
        "[Setting up drivers](setup.md) has the commands for each file. `not run`: the case is newer than the file, or "
        "too slow.\n\n";
    text += devices_table(all);
    text +=
        "\nThe first picture is the time from the start of a render to the first sample of every pixel.\n"
        "Nothing was compiled before, and other programs may have run on the machine.\n"
        "\n## Cases\n\n" +
        cases_table(all);
    if (std::ranges::any_of(all, fails)) text += "\n## What is wrong\n\n" + failures_table(all);
    return text;
}

}  // namespace claray::cli
