// Options: what is no value, what contradicts, what would do nothing. One line in claray's words, whatever the parser
// says.
#include <fstream>
#include <regex>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

constexpr const char* commands[] = {"devices", "scenes", "render", "explain", "compile", "bake",
                                    "build",   "bench",  "tune",   "verify",  "accuracy"};

/// The long options of a command that take a value, with the kind of value that the help tells.
std::vector<std::pair<std::string, std::string>> options_with_values(const std::string& command) {
    const std::string help = run_claray({command, "--help-all"}).output;
    const std::regex line("\n  [^\n]*?(--[a-z-]+)(?:,[a-z]+)? ([A-Z]+)[^\n]*");
    std::vector<std::pair<std::string, std::string>> found;
    for (auto it = std::sregex_iterator(help.begin(), help.end(), line); it != std::sregex_iterator(); ++it)
        found.emplace_back((*it)[1], (*it)[2]);
    return found;
}

testing::AssertionResult in_own_words(const ProcessResult& result, const std::string& words) {
    for (const char* raw : {"Could not convert", "not in range", "FAILED", "required", "not expected", "Check ", "{",
                            "excludes", "e+", ".000000"})
        if (result.errors.find(raw) != std::string::npos)
            return testing::AssertionFailure() << "'" << raw << "' in " << result.errors;
    return failed_with(result, 2, words);
}

std::vector<std::string> called(const std::string& command, const std::vector<std::string>& more) {
    std::vector<std::string> all = {command};
    if (command == "render" || command == "explain" || command == "bake" || command == "build" || command == "accuracy")
        all.emplace_back("cornell");
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

TEST(OptionRules, EveryOptionSaysThatItsValueIsMissing) {
    std::size_t tried = 0;
    for (const char* command : commands)
        for (const auto& [option, kind] : options_with_values(command)) {
            ++tried;
            EXPECT_TRUE(in_own_words(run_claray(called(command, {option})), option + " needs a value")) << command;
        }
    EXPECT_GT(tried, 70u);
}

TEST(OptionRules, EveryNumberAndNameIsChecked) {
    std::size_t tried = 0;
    for (const char* command : commands)
        for (const auto& [option, kind] : options_with_values(command)) {
            if (kind != "UINT" && kind != "INT" && kind != "FLOAT" && kind != "NAME" && kind != "TIME") continue;
            ++tried;
            for (const char* value : {"much", "nan", "1e999"})
                EXPECT_TRUE(in_own_words(run_claray(called(command, {option, value})), option + ": "))
                    << command << value;
        }
    EXPECT_GT(tried, 30u);
}

TEST(OptionRules, MessagesNameTheChoicesAndTheRange) {
    const auto says = [](const std::vector<std::string>& arguments, const std::string& words) {
        EXPECT_TRUE(in_own_words(run_claray(arguments), words));
    };
    says({"render", "cornell", "--layout", "tall"}, "--layout: unknown name 'tall'; choose automatic, binary or wide");
    says({"render", "cornell", "--noise", "0"}, "--noise: '0' is not a number of more than 0");
    says({"render", "cornell", "--exposure", "1e39"}, "--exposure: '1e39' is not a number; write it as in -1.5");
    says({"render", "cornell", "--spp", "16777217"}, "--spp: '16777217' is not a whole number in 1..16777216");
    says({"render", "cornell", "--spp", "-3"}, "--spp: '-3' is not a whole number in 1..16777216");
    says({"render", "cornell", "--spp", "1.5"}, "--spp: '1.5' is not a whole number");
    says({"render", "cornell", "--time", "3weeks"},
         "--time: '3weeks' is not a time of more than 0; write it as in 500ms");
    says({"render", "cornell", "--aov", "depth,beauty"}, "--aov: unknown name 'beauty'; choose depth, normal, albedo");
    says({"render", "cornell", "--bogus", "3"}, "unknown option '--bogus'; see claray render --help");
    says({"render", "cornell", "second", "third", "-o", "x.png"}, "'second' is an unexpected argument");
    says({"explain", "cornell", "--only", "sky", "--only", "glass"}, "--only is given more than once");
    says({"render", "cornell", "-O", "x.png"}, "unknown option '-O' (did you mean '-o'?); see claray render --help");
    says({"render", "--bogus"}, "unknown option '--bogus'");  // though the scene is missing, too
    says({"--bogus"}, "unknown option '--bogus'; see claray --help");
    says({"render", "cornell", "-o", ""}, "--output has an empty value");
    says({"devices", "render"}, "'render' is an unexpected argument; see claray devices --help");
}

TEST(OptionRules, WhatWouldDoNothingIsRefused) {
    const TemporaryFolder folder;
    const std::string tree = (folder / "tree.cbvh").string(), image = (folder / "x.png").string();
    ASSERT_EQ(run_claray({"build", "soup:50", "-o", tree, "--repeat", "1"}).exit_code, 0);
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
        {{"render", "cornell", "-o", image, "--focus-distance", "2"}, "--focus-distance has no effect without a lens"},
        {{"render", "cornell", "-o", image, "--checkpoint-every", "2s"}, "no effect without --checkpoint"},
        {{"render", "cornell", "-o", image, "--frames", "2"}, "'2' is not a range of frames"},
        {{"render", "cornell", "-o", image, "--sky", "1", "--environment", "a.hdr"},
         "--sky and --environment contradict"},
        {{"render", "cornell", "--fps", "5", "--exposure", "1"}, "--exposure has no effect without --output"},
        {{"render", "cornell", "--fps", "5", "--tone-map", "none"}, "--tone-map has no effect without --output"},
        {{"render", "cornell", "--fps", "5", "--trace", "t.json"}, "--fps and --trace contradict"},
        {{"render", "cornell", "--fps", "5", "--stats"}, "--fps and --stats contradict"},
        {{"render", "cornell", "-o", image, "--trace", image}, "--output and --trace are the same file"},
        {{"render", "cornell", "-o", image, "--checkpoint", (folder / "." / "x.png").string()}, "are the same file"},
        {{"build", tree, "--builder", "high"}, "--builder: '" + tree + "' is a saved tree and is not built again"},
        {{"build", tree, "--repeat", "2"}, "is a saved tree and is not built again"},
        {{"build", "soup:50", "-o", (folder / "tree.obj").string()}, "use the extension .cbvh"},
        {{"verify", "--scene", "cornell"}, "--scene has no effect without --compare"},
        {{"verify", "--rounds", "2"}, "--rounds has no effect without --compare"},
        {{"verify", "--compare", "--html", "x.html"}, "--compare and --html contradict"},
        {{"verify", "--quick", "--full"}, "--quick and --full contradict"},
        {{"verify", "--list", "--case", "srgb"}, "--list and --case contradict"},
        {{"accuracy", "cornell", "--check", "--csv", "x.csv"}, "--check and --csv contradict"},
        {{"tune", "--dry-run", "-o", "x.txt"}, "--dry-run and --output contradict"}};
    for (const auto& [arguments, words] : cases) EXPECT_TRUE(failed_with(run_claray(arguments), 2, words)) << words;
}

TEST(OptionRules, PictureOptionsOfAnHdrImageAreAWarning) {
    const TemporaryFolder folder;
    const ProcessResult result = run_claray({"render", "cornell", "-o", (folder / "x.hdr").string(), "--size", "8x8",
                                             "--spp", "1", "-q", "--exposure", "1"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(
        result.errors.find("claray: warning: --exposure and --tone-map apply to .png, .jpg, .webp and videos only"),
        std::string::npos);
}

// The parser's own conversion takes a leading 0 for octal.
TEST(OptionRules, NumbersAreDecimal) {
    const TemporaryFolder folder;
    const ProcessResult result =
        run_claray({"render", "cornell", "-o", (folder / "x.png").string(), "--size", "8x8", "--spp", "010", "-q"});
    EXPECT_NE(result.output.find(" 10 spp"), std::string::npos) << result.output << result.errors;
}

TEST(OptionRules, FoldersThatCannotBeMade) {
    const TemporaryFolder folder;
    const std::string file = (folder / "file").string();
    std::ofstream{file};
    for (const char* option : {"--svgs", "--maps"})
        EXPECT_TRUE(
            failed_with(run_claray({"accuracy", "cornell", option, file + "/plots"}), 1, "cannot create the folder"));
}

}  // namespace
}  // namespace claray::test
