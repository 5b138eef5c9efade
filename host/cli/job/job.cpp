#include "host/cli/job/job.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "claray/error.hpp"
#include "claray/scene.hpp"
#include "host/base/did_you_mean.hpp"
#include "host/base/file.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/help/option_facts.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_flags.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* job_group = "Job files";
constexpr const char* schema_key = "$schema";  // by which editors find the schema; no option

/// What a job can hold: arguments and options, but those that print something else than a picture.
std::vector<const CLI::Option*> settings_of(const CLI::App& command) {
    std::vector<const CLI::Option*> settings = positionals_of(command);
    for (const CLI::Option* option : options_of(command))
        if (option != command.get_help_ptr() && option != command.get_help_all_ptr() &&
            option->get_group() != job_group)
            settings.push_back(option);
    return settings;
}

/// "X,Y,Z", which a job may have as three numbers.
bool is_tuple(const CLI::Option& option) {
    return !is_list(option) && option.get_type_name().find(',') != std::string::npos;
}

bool takes_several(const CLI::Option& option) { return is_list(option) || is_repeatable(option); }

/// How a job's value is written, for errors.
const char* form_of(const CLI::Option& option) {
    if (!takes_value(option)) return choices_of(option).empty() ? "true or false" : "true, false or a name";
    if (takes_several(option)) return "text, or a list of texts";
    if (is_tuple(option)) return "a list of numbers, or text";
    return is_number(option) ? "a number" : "text or a number";
}

bool fits(const CLI::Option& option, const Json& value) {
    const auto is_scalar = [](const Json& one) { return one.is_string() || one.is_number(); };
    if (!takes_value(option)) return value.is_boolean() || (value.is_string() && !choices_of(option).empty());
    if (is_number(option)) return value.is_number();
    if (!value.is_array()) return is_scalar(value);
    return (takes_several(option) || is_tuple(option)) && std::ranges::all_of(value, is_scalar);
}

Json schema_of(const CLI::Option& option) {
    const std::vector<std::string> choices = choices_of(option);
    const Json number = {{"type", "number"}}, text = {{"type", "string"}};
    const Json name = choices.empty() ? text : Json{{"enum", choices}};
    Json schema;
    if (!takes_value(option))
        schema = choices.empty() ? Json{{"type", "boolean"}} : Json{{"anyOf", {{{"type", "boolean"}}, name}}};
    else if (takes_several(option))
        schema = {{"anyOf", {text, {{"type", "array"}, {"items", name}}}}};
    else if (is_tuple(option))
        schema = {{"anyOf", {text, {{"type", "array"}, {"items", number}}}}};
    else if (is_number(option))
        schema = number;
    else
        schema = choices.empty() ? Json{{"type", {"string", "number"}}} : name;
    schema["description"] = option.get_description();
    return schema;
}

Json job_schema(const CLI::App& command) {
    Json properties = {{schema_key, {{"type", "string"}}}};
    for (const CLI::Option* option : settings_of(command)) properties[key_of(*option)] = schema_of(*option);
    return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
            {"title", "A render of claray " CLARAY_VERSION},
            {"description", "Options of claray render. Paths begin at the folder of the job."},
            {"type", "object"},
            {"properties", properties},
            {"additionalProperties", false}};
}

/// The number that is all of `text`, else the text.
Json number_or_text(const std::string& text) {
    if (const auto whole = parse_number<std::int64_t>(text)) return *whole;
    if (const auto real = parse_number<double>(text)) return *real;
    return text;
}

Json job_value(const CLI::Option& option) {
    std::vector<std::string> texts = option.reduced_results();
    for (std::string& text : texts) text = choice_named(option, text);
    if (!takes_value(option) && (texts[0] == "true" || texts[0] == "false")) return texts[0] == "true";
    if (takes_several(option)) return texts;
    if (is_number(option)) return number_or_text(texts[0]);
    if (!is_tuple(option)) return texts[0];
    Json numbers = Json::array();
    for (const std::string& word : split(texts[0])) numbers.push_back(number_or_text(word));
    return std::ranges::all_of(numbers, [](const Json& one) { return one.is_number(); }) ? numbers : Json(texts[0]);
}

Json job_of(const CLI::App& command) {
    Json job;
    for (const CLI::Option* option : settings_of(command))
        if (option->count() > 0) job[key_of(*option)] = job_value(*option);
    return job;
}

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// "--key=value" for each value, as CLI11 reads them.
std::vector<std::string> arguments_of(const CLI::App& command, const Json& job) {
    std::vector<std::string> arguments = {command.get_name()};
    for (const CLI::Option* option : settings_of(command)) {
        const std::string key = key_of(*option);
        if (!job.contains(key)) continue;
        const Json& value = job[key];
        if (value.is_boolean() && !choices_of(*option).empty()) {  // a name may follow such a flag
            if (value) arguments.push_back("--" + key);
            continue;
        }
        const std::string begin = option->get_positional() ? "" : "--" + key + "=";
        std::vector<std::string> texts;
        for (const Json& one : value.is_array() ? value : Json::array({value})) texts.push_back(text_of(one));
        if (is_tuple(*option)) texts = {CLI::detail::join(texts, ",")};
        for (const std::string& text : texts) arguments.push_back(begin + text);
    }
    return arguments;
}

bool is_builtin_scene(const std::string& name) {
    const auto family = [](std::string_view one) { return one.substr(0, one.find(':')); };
    return std::ranges::any_of(builtin_scene_names(), [&](const char* one) { return family(one) == family(name); });
}

/// A path of a job, whose folder it begins at. In MESH=FILE it follows the sign.
std::string path_from(const fs::path& folder, const CLI::Option& option, const std::string& text) {
    if (text == "-" || (option.get_positional() && is_builtin_scene(text))) return text;
    const std::size_t begin = option.get_type_name() == file_value ? 0 : text.find('=') + 1;
    return text.substr(0, begin) + (folder / text.substr(begin)).string();
}

void resolve_paths(const fs::path& folder, const CLI::Option& option, Json& value) {
    if (value.is_array())
        for (Json& one : value) resolve_paths(folder, option, one);
    else
        value = path_from(folder, option, text_of(value));
}

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::usage, "'" + path + "': " + what, remedy);
}

/// Checks keys and types, and resolves paths.
Json checked_job(const CLI::App& command, const std::string& path, Json job) {
    std::vector<std::string> keys;
    for (const CLI::Option* option : settings_of(command)) keys.push_back(key_of(*option));
    job.erase(schema_key);
    for (const auto& [key, value] : job.items())
        if (std::ranges::count(keys, key) == 0)
            refuse(path, "unknown key '" + key + "'" + did_you_mean(key, keys), "see claray render --help-all");
    for (const CLI::Option* option : settings_of(command)) {
        const std::string key = key_of(*option);
        if (!job.contains(key)) continue;
        if (!fits(*option, job[key]))
            refuse(path, "'" + key + "' is of the type " + job[key].type_name(),
                   std::string("write ") + form_of(*option));
        if (names_file(*option)) resolve_paths(fs::path(path).parent_path(), *option, job[key]);
    }
    if (!job.contains("scene")) refuse(path, "the scene is missing", "add the key 'scene'");
    return job;
}

/// Nothing for a glTF, which may have any extension.
std::optional<Json> read_job(const std::string& path) {
    const std::string text = read_file(path, "check the path");
    Json job;
    try {
        job = Json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
        const std::string what = error.what();
        const std::size_t place = what.find("line ");
        throw Error(ErrorKind::user, "'" + path + "' is no JSON: " + what.substr(std::min(place, what.size())),
                    "mend it, or write one by claray render ... --print-job");
    }
    if (!job.is_object()) refuse(path, "it is " + std::string(job.type_name()), "write an object of options");
    if (job.contains("asset")) return {};
    return job;
}

}  // namespace

void add_job_options(CLI::App& command, JobOptions& options) {
    const OptionGroup group(command, job_group);
    command.add_flag("--print-job", options.print,
                     "Print what is chosen as JSON, for claray render FILE.json; render nothing");
    command.add_flag_callback(
        "--job-schema",
        [&command] {
            const std::string text = json_text(job_schema(command));
            throw CLI::CallForVersion(text.substr(0, text.find_last_not_of('\n') + 1), 0);  // which ends the line
        },
        "Print the JSON Schema of such files");
}

std::string job_text(const CLI::App& command) { return json_text(job_of(command)); }

std::vector<std::string> without_job(const std::vector<std::string>& arguments) {
    // The first parse tells which argument is the scene; it checks nothing that a job may complete.
    CLI::App app;
    RenderOptions options;
    JobOptions job_options;
    set_help(app);
    CLI::App& command = *app.add_subcommand("render");
    command.option_defaults()->take_last();
    add_render_options(command, options);
    add_job_options(command, job_options);
    for (CLI::Option* option : command.get_options()) option->required(false);
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError&) {
        return arguments;  // whose parse fails again, or prints help
    } catch (const Error&) {
        return arguments;
    }
    const Json chosen = job_of(command);
    if (!command.parsed() || !chosen.contains("scene")) return arguments;
    const std::string path = chosen["scene"];
    if (fs::path(path).extension() != ".json") return arguments;
    const auto read = read_job(path);
    if (!read) return arguments;
    Json job = checked_job(command, path, *read);
    for (const auto& [key, value] : chosen.items())
        if (key != "scene") job[key] = value;
    std::vector<std::string> without = arguments_of(command, job);
    if (job_options.print) without.emplace_back("--print-job");
    return without;
}

}  // namespace claray::cli
