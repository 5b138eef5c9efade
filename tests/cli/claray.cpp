#include "tests/cli/claray.hpp"

#include <algorithm>
#include <regex>
#include <sstream>

#include "tests/support/device.hpp"

namespace claray::test {

std::vector<std::string> claray_command(const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {CLARAY_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
}

ProcessResult run_claray(const std::vector<std::string>& arguments, const Variables& environment) {
    Variables all = environment;
    all.emplace("CLARAY_DEVICE", std::to_string(device().info().index));
    return run_process(claray_command(arguments), all);
}

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

std::vector<float> read_pfm(const std::string& path, std::size_t channels) {
    std::istringstream file(read_file(path));
    std::string kind;
    std::size_t width = 0, height = 0;
    float scale = 0;
    file >> kind >> width >> height >> scale;
    file.get();
    EXPECT_EQ(kind, channels == 3 ? "PF" : "Pf");
    EXPECT_LT(scale, 0.f);  // little endian
    std::vector<float> values(width * height * channels);
    file.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    return file ? values : std::vector<float>();
}

void wait_for_samples(const Process& render) {
    static const std::regex some("[1-9][0-9]*/[0-9]+ spp");
    EXPECT_TRUE(render.brings_about([&] { return std::regex_search(render.errors_so_far(), some); }));
}

testing::AssertionResult failed_with(const ProcessResult& result, int exit_code, const std::string& words) {
    // What fails after kernels were compiled has told of them: how many depends on the tests that ran before.
    static const std::regex compiling("claray: compiling [^\n]* kernels, once for this device\n");
    const std::string errors = std::regex_replace(result.errors, compiling, "");
    if (result.exit_code != exit_code)
        return testing::AssertionFailure()
               << "exit code " << result.exit_code << " instead of " << exit_code << ": " << errors;
    if (std::count(errors.begin(), errors.end(), '\n') != 1 || !errors.starts_with("claray: error: "))
        return testing::AssertionFailure() << "not one line of error: " << errors;
    if (errors.find(words) == std::string::npos)
        return testing::AssertionFailure() << "no '" << words << "' in: " << errors;
    return testing::AssertionSuccess();
}

}  // namespace claray::test
