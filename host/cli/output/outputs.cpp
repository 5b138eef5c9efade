#include "host/cli/output/outputs.hpp"

#include "host/base/file.hpp"

namespace claray::cli {
namespace {

[[noreturn]] void refuse_one_file(const std::string& option, const std::string& other,
                                  const std::filesystem::path& path) {
    throw Error(ErrorKind::usage, option + " and " + other + " are the same file, '" + path.string() + "'",
                "use different files");
}

/// True if the standard output goes to this file. The path /dev/stdout itself is allowed.
bool is_standard_output(const std::filesystem::path& path) {
    const std::filesystem::path output = "/dev/stdout";
    return are_one_file(path, output) && write_target(path) != write_target(output);
}

}  // namespace

void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const auto& [option, path] = outputs[i];
        if (path.empty()) continue;
        for (std::size_t k = i + 1; k < outputs.size(); ++k)
            if (!outputs[k].path.empty() && are_one_file(path, outputs[k].path))
                refuse_one_file(option, outputs[k].option, path);
        for (const NamedFile& input : inputs)
            if (!input.path.empty() && are_one_file(path, input.path)) refuse_one_file(option, input.option, path);
        if (is_standard_output(path)) refuse_one_file(option, "standard output", path);
        check_file_writable(path);
    }
}

}  // namespace claray::cli
