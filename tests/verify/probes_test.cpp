// Probes of drivers, and what `--reduce` writes of them: programs that compile, run and notice a fault by themselves.
// Each case of family driver is run by verify_test.cpp.
#include "host/verify/probes/probes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "host/base/file.hpp"
#include "host/verify/probes/reduce.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

auto lines_of(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(Probes, AreShortAndNeedNothing) {
    for (const std::string& name : verify::probe_names()) {
        const verify::ProbeTexts texts = verify::probe_texts(name);
        EXPECT_LE(lines_of(texts.kernel), 60) << name;
        EXPECT_LE(lines_of(texts.program), 80) << name;
        EXPECT_EQ(texts.kernel.find("#include") == std::string::npos, name != "headers") << name;
        EXPECT_EQ(texts.program.find("#include \""), std::string::npos) << name;
    }
}

TEST(Probes, AllKernelsAndBodiesHaveOne) {
    std::size_t kernels = 0, own_bodies = 0;
    for (const KernelSource& text : verify::embedded_probe_texts()) {
        kernels += text.path.ends_with(".cl");
        std::string name = std::filesystem::path(text.path).stem();
        std::replace(name.begin(), name.end(), '_', '-');
        if (!text.path.starts_with("bodies/") || name == "kernel-only") continue;
        EXPECT_TRUE(verify::is_probe(name)) << text.path;
        ++own_bodies;
    }
    EXPECT_EQ(kernels, verify::probe_names().size());
    EXPECT_GT(own_bodies, 10u);
}

/// Compiles what was written for a probe and runs it.
ProcessResult run_written(const std::filesystem::path& folder, const std::string& name) {
    const std::string script = "cd '" + folder.string() + "' && cc " + name + ".c -lOpenCL -o " + name + " 2>&1 && ./" +
                               name + ' ' + std::to_string(device().info().index);
    return run_process({"sh", "-c", script});
}

TEST(Reduce, WritesProgramsThatTellARightDeviceFromAWrongOne) {
    const TemporaryFolder folder;
    for (const std::string name : {"struct-addresses", "queues"}) {  // by the common body, and by one of its own
        const std::string command = verify::write_probe(folder.path(), name);
        EXPECT_NE(command.find("cc " + name + ".c -lOpenCL"), std::string::npos) << command;
        const ProcessResult right = run_written(folder.path(), name);
        EXPECT_EQ(right.exit_code, 0) << right.output << right.errors;
        EXPECT_NE(right.output.find(device().info().name), std::string::npos) << right.output;
        EXPECT_NE(right.output.find(device().info().driver), std::string::npos) << right.output;
        std::string kernel = verify::probe_texts(name).kernel;
        const std::string from = name == "queues" ? "right ? step + 1" : "*a = *b, *b = kept",
                          to = name == "queues" ? "right ? step" : "*a = *b";
        kernel.replace(kernel.find(from), from.size(), to);
        write_file(folder / (name + ".cl"), kernel);
        const ProcessResult wrong = run_written(folder.path(), name);
        EXPECT_EQ(wrong.exit_code, 1) << wrong.output << wrong.errors;
        EXPECT_NE(wrong.output.find("the first wrong item: 0"), std::string::npos) << wrong.output;
    }
    std::filesystem::remove(folder / "queues.cl");
    EXPECT_EQ(run_written(folder.path(), "queues").exit_code, 2);
}

/// A case that holds, or fails by `wrong` results.
VerifyResult result_of(const std::string& name, bool holds) {
    VerifyResult result;
    result.name = name;
    result.checks = {{"results", 10, holds ? 0.0 : 1.0, 0, "wrong"}};
    return result;
}

TEST(Reduce, ChoosesWhatFails) {
    std::vector<std::string> failing, said;
    const verify::RunCases run = [&](const std::vector<std::string>& names, const auto& report) {
        for (const std::string& name : names)
            report(result_of(name, std::find(failing.begin(), failing.end(), name) == failing.end()));
    };
    const auto chosen = [&](const std::vector<std::string>& names) {
        said.clear();
        return verify::probes_to_write(names, run, [&](const std::string& line) { said.push_back(line); });
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(chosen({}), Names{});
    EXPECT_EQ(said, Names{"no probe fails: the fault cannot be shown without claray"});
    EXPECT_EQ(chosen({"images"}), Names{"images"});  // asked for
    EXPECT_EQ(chosen({"sort"}), Names{});
    EXPECT_EQ(said.size(), 1u);
    failing = {"long-loops", "sort"};
    EXPECT_EQ(chosen({}), Names{"long-loops"});
    EXPECT_EQ(chosen({"sort", "images"}), (Names{"images", "long-loops"}));
    EXPECT_EQ(said, (Names{"sort fails", "long-loops fails"}));
    EXPECT_EQ(chosen({"edges"}), Names{});
}

}  // namespace
}  // namespace claray::test
