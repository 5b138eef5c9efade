// The help of commands, suggestions for misspelt names, the manual page and completions: all made from the options.
#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

std::string printed_by(const std::vector<std::string>& arguments) {
    const ProcessResult result = run_claray(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    return result.output;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

/// The names of commands: of the lines below "Commands:".
std::vector<std::string> commands() {
    std::vector<std::string> names;
    const std::string help = printed_by({"--help"});
    for (const std::string& line : lines_of(help.substr(help.find("\nCommands:\n") + 11))) {
        if (line.empty()) break;
        if (line.starts_with("   ")) continue;  // more of the text beside the one above
        names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return names;
}

TEST(Help, IsShortAndAllOfItIsLonger) {
    const std::string help = printed_by({"render", "--help"}), all = printed_by({"render", "--help-all"});
    EXPECT_LE(lines_of(help).size(), 80u) << help;
    EXPECT_GT(lines_of(all).size(), 120u);
    for (const char* group : {"Output", "Camera", "Light", "Quality", "Animation", "Device"}) {
        EXPECT_TRUE(has(help, "\n" + std::string(group) + ":\n")) << group;
        EXPECT_TRUE(has(all, "\n" + std::string(group) + ":\n")) << group;
    }
    EXPECT_TRUE(has(help, "More, by --help-all: ")) << help;
    EXPECT_TRUE(has(all, "\nLight grid:\n") && has(all, "--grid-voxels") && !has(help, "--grid-voxels"));
    for (const std::string& line : lines_of(help + all)) EXPECT_LE(line.size(), 110u) << line;
}

TEST(Help, EveryCommandHasBoth) {
    const std::string all = printed_by({"--help-all"});
    for (const std::string& command : commands()) {
        EXPECT_TRUE(has(printed_by({command, "--help"}), "Usage: claray " + command + " ")) << command;
        EXPECT_TRUE(has(printed_by({command, "--help-all"}), "--help-all")) << command;
        EXPECT_TRUE(has(all, "Usage: claray " + command + " ")) << command;
    }
    EXPECT_GE(commands().size(), 18u);
    const std::string bench = printed_by({"bench", "--help"});  // an argument that is an option, too
    EXPECT_TRUE(has(bench, "\n  scene ") && has(bench, "\n  --scene ")) << bench;
}

TEST(Help, MisspeltNamesAreSuggested) {
    const std::vector<std::string> image = {"render", "cornell", "-o", "x.png"};
    const auto tells = [](const std::vector<std::string>& arguments, const std::string& words) {
        return failed_with(run_claray(arguments), 2, words);
    };
    EXPECT_TRUE(tells({"rendre"}, "unknown command 'rendre' (did you mean 'render'?); see claray --help"));
    EXPECT_TRUE(tells(with(image, {"--exposur", "1"}), "unknown option '--exposur' (did you mean '--exposure'?)"));
    EXPECT_TRUE(tells(with(image, {"--denoize=oidn"}), "unknown option '--denoize' (did you mean '--denoise'?)"));
    EXPECT_TRUE(tells(with(image, {"--aov", "dept"}), "unknown name 'dept' (did you mean 'depth'?); choose depth, "));
    EXPECT_TRUE(tells(with(image, {"--tone-map", "acse"}), "unknown name 'acse' (did you mean 'aces'?)"));
    EXPECT_TRUE(tells({"render", "cornel", "-o", "x.png"}, "unknown scene 'cornel' (did you mean 'cornell'?)"));
    EXPECT_TRUE(tells({"render", "terain:9", "-o", "x.png"}, "unknown scene 'terain:9' (did you mean 'terrain:9'?)"));
    EXPECT_TRUE(tells(with(image, {"--device", "cup"}), "no device matches 'cup' (did you mean 'cpu'?); available: "));
    const std::string posed = std::string(CLARAY_SOURCE_DIR) + "/tests/fuzz/corpus/gltf/posed.gltf";
    EXPECT_TRUE(tells({"render", posed, "-o", "x.png", "--file-camera", "nothing like it"}, "has no camera"));
}

class Shells : public InFolder {
protected:
    /// The words that a shell offers for a command line. Skips where there is no such shell.
    [[nodiscard]] std::string run(const std::string& shell, const std::string& script) {
        std::ofstream(path("claray." + shell)) << printed_by({"completion", shell});
        std::ofstream(path("script")) << script;
        const ProcessResult result = run_process({shell, path("script")}, {{"SCRIPT", path("claray." + shell)}});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_EQ(result.errors, "");
        return result.output;
    }
    static bool exists(const std::string& shell) {
        return run_process({"sh", "-c", "command -v " + shell}).exit_code == 0;
    }
};

TEST_F(Shells, BashCompletes) {
    if (!exists("bash")) GTEST_SKIP() << "no bash here";
    const auto offered = [&](const std::string& words, int place) {
        return run("bash", "source \"$SCRIPT\"\nCOMP_WORDS=(" + words + ") COMP_CWORD=" + std::to_string(place) +
                               "\n_claray\nprintf '%s ' \"${COMPREPLY[@]}\"\n");
    };
    EXPECT_EQ(offered("claray ren", 1), "render ");
    EXPECT_EQ(offered("claray render cornell --sp", 3), "--spp ");
    EXPECT_EQ(offered("claray render cornell --tone-map a", 4), "aces ");
    EXPECT_EQ(offered("claray render cornell --aov depth,nor", 4), "depth,normal ");
    EXPECT_EQ(offered("claray render cornell --denoise = oi", 5), "oidn ");
    EXPECT_EQ(offered("claray render corn", 2), "cornell ");
    EXPECT_EQ(offered("claray completion f", 2), "fish ");
    EXPECT_EQ(offered("claray render cornell --spp 1", 4), " ") << "any number";
    EXPECT_EQ(offered("claray render " + path("scr"), 2), path("script") + " ") << "a file";
}

/// A second zsh, in a terminal of its own, completes at a tab; what it finds goes to a file.
TEST_F(Shells, ZshCompletes) {
    if (!exists("zsh")) GTEST_SKIP() << "no zsh here";
    std::ofstream(path("init")) << "PS1= PS2=\nautoload -Uz compinit\ncompinit -u -D\nsource $SCRIPT\n"
                                   "compadd() {\n"
                                   "    local -a hits\n"
                                   "    [[ \" ${@[1,(i)(-|--)]} \" == *' -'[OAD]' '* ]] || {\n"
                                   "        builtin compadd -A hits \"$@\"\n"
                                   "        print -rl -- $hits >> $SCRIPT.offered\n"
                                   "    }\n"
                                   "    builtin compadd \"$@\"\n"
                                   "}\n"
                                   "comppostfuncs=(exit)\n";
    const auto offers = [&](const std::string& line, const std::string& word) {
        const std::string told = run("zsh",
                                     "zmodload zsh/zpty\nexport SCRIPT\n: > $SCRIPT.offered\nzpty z zsh -f -i\n"
                                     "zpty -w z 'source " +
                                         path("init") +
                                         "'\n"
                                         "zpty -w -n z '" +
                                         line +
                                         "'$'\\t'\n"
                                         "while zpty -r z output; do :; done\ncat $SCRIPT.offered\n");
        const std::vector<std::string> lines = lines_of(told);
        return std::ranges::count(lines, word) > 0 ? testing::AssertionSuccess() : testing::AssertionFailure() << told;
    };
    EXPECT_TRUE(offers("claray ren", "render"));
    EXPECT_TRUE(offers("claray render cornell --sp", "--spp"));
    EXPECT_TRUE(offers("claray render cornell --tone-map a", "aces"));
    EXPECT_TRUE(offers("claray render cornell --aov depth,nor", "normal"));
    EXPECT_TRUE(offers("claray render cornell --denoise=oi", "oidn"));
    EXPECT_TRUE(offers("claray render corn", "cornell"));
    EXPECT_TRUE(offers("claray render " + path("ini"), "init"));
    EXPECT_FALSE(offers("claray scenes --", "--spp"));
}

TEST_F(Shells, FishCompletes) {
    if (!exists("fish")) GTEST_SKIP() << "no fish here";
    const auto offers = [&](const std::string& line, const std::string& word) {
        const std::string told = run("fish", "source $SCRIPT\ncomplete -C '" + line + "'\n");
        for (const std::string& one : lines_of(told))
            if (one.substr(0, one.find('\t')) == word) return testing::AssertionSuccess();
        return testing::AssertionFailure() << told;
    };
    EXPECT_TRUE(offers("claray ren", "render"));
    EXPECT_TRUE(offers("claray render cornell --sp", "--spp"));
    EXPECT_TRUE(offers("claray render cornell --tone-map a", "aces"));
    EXPECT_TRUE(offers("claray render corn", "cornell"));
    EXPECT_FALSE(offers("claray scenes --", "--spp"));
}

TEST_F(Shells, TheManualPageHasAllOptionsAndNoFault) {
    const std::string page = printed_by({"man"});
    EXPECT_TRUE(has(page, ".SS claray render\n"));
    for (const std::string& line : lines_of(printed_by({"render", "--help-all"})))
        if (const std::size_t begin = line.find("--"); begin < 8 && line.starts_with("  ")) {
            std::string name = line.substr(begin, line.find_first_of(" ,[", begin) - begin), escaped;
            for (const char c : name) escaped += c == '-' ? "\\-" : std::string(1, c);
            EXPECT_TRUE(has(page, escaped)) << name;
        }
    std::ofstream(path("claray.1")) << page;
    if (exists("man")) {
        const ProcessResult man =
            run_process({"man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", path("claray.1")});
        EXPECT_EQ(man.errors, "");
        EXPECT_EQ(man.exit_code, 0);
    }
    if (exists("mandoc")) {
        const ProcessResult lint = run_process({"mandoc", "-T", "lint", "-W", "warning", path("claray.1")});
        EXPECT_FALSE(has(lint.output + lint.errors, "ERROR")) << lint.output;
    }
}

}  // namespace
}  // namespace claray::test
