// What the program prints: help, version, devices, scenes.
#include <nlohmann/json.hpp>
#include <sstream>

#include "claray/device.hpp"
#include "claray/scene.hpp"
#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

TEST(Commands, VersionAndHelp) {
    const ProcessResult version = run_claray({"--version"});
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_EQ(version.output.substr(0, 7), "claray ");
    for (const char* command : {"", "devices", "scenes", "render", "build", "bench", "tune"}) {
        std::vector<std::string> arguments = {"--help"};
        if (*command) arguments.insert(arguments.begin(), command);
        const ProcessResult help = run_claray(arguments);
        EXPECT_EQ(help.exit_code, 0) << command;
        EXPECT_NE(help.output.find("--help"), std::string::npos) << command;
    }
    EXPECT_NE(run_claray({"render", "--help"}).output.find("Examples:"), std::string::npos);
}

TEST(Commands, DevicesAsTable) {
    const ProcessResult result = run_claray({"devices"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const DeviceInfo& info : list_devices()) {
        EXPECT_NE(result.output.find(info.name), std::string::npos);
        EXPECT_NE(result.output.find(info.driver), std::string::npos);
    }
    for (const char* column : {"index", "type", "platform", "memory", "max allocation", "extensions"})
        EXPECT_NE(result.output.find(column), std::string::npos) << column;
}

TEST(Commands, DevicesAsJson) {
    const ProcessResult result = run_claray({"devices", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto devices = nlohmann::json::parse(result.output);
    const std::vector<DeviceInfo> infos = list_devices();
    ASSERT_EQ(devices.size(), infos.size());
    for (std::size_t i = 0; i < infos.size(); ++i) {
        EXPECT_EQ(devices[i].at("index"), i);
        EXPECT_EQ(devices[i].at("name"), infos[i].name);
        EXPECT_EQ(devices[i].at("type"), to_string(infos[i].type));
        EXPECT_EQ(devices[i].at("driver"), infos[i].driver);
        const auto memory = devices[i].at("memory_bytes").get<double>();  // drivers may tell what is free just now
        EXPECT_NEAR(memory, double(infos[i].memory), 0.5 * double(infos[i].memory));
        EXPECT_EQ(devices[i].at("max_allocation_bytes"), infos[i].max_allocation);
        EXPECT_EQ(devices[i].at("extensions").size(), infos[i].extensions.size());
    }
}

TEST(Commands, ScenesAsTextAndJson) {
    const ProcessResult text = run_claray({"scenes"}), json = run_claray({"scenes", "--json"});
    ASSERT_EQ(text.exit_code, 0);
    std::istringstream lines(text.output);
    for (const std::string name : nlohmann::json::parse(json.output)) {
        std::string line;
        std::getline(lines, line);
        EXPECT_TRUE(line.starts_with(name + "  ") && line.size() > 25) << "no name and description: " << line;
    }
    for (const char* name : builtin_scene_names()) EXPECT_NE(text.output.find(name), std::string::npos);
}

TEST(Commands, FullDiskUnderStandardOutput) {
    const ProcessResult result = run_process({"sh", "-c", std::string(CLARAY_PROGRAM) + " devices > /dev/full"});
    EXPECT_TRUE(failed_with(result, 1, "cannot write to standard output: No space left on device"));
}

TEST(Commands, BadCommandLines) {
    EXPECT_TRUE(failed_with(run_claray({}), 2, "the command is missing"));
    EXPECT_TRUE(failed_with(run_claray({"no-such-command"}), 2, "no-such-command"));
    EXPECT_TRUE(failed_with(run_claray({"devices", "--no-such-option"}), 2, "--no-such-option"));
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell"}), 2, "--output"));
    EXPECT_TRUE(failed_with(run_claray({"render", "-o", "x.png"}), 2, "scene"));
}

/// Windows, the web page and MPI bring some sixty libraries, which only the commands load that need them.
TEST(Commands, LoadsFewLibraries) {
    const ProcessResult result = run_process({CLARAY_PROGRAM, "devices"}, {{"LD_TRACE_LOADED_OBJECTS", "1"}});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("libOpenCL.so"), std::string::npos) << result.output;
    EXPECT_LE(std::count(result.output.begin(), result.output.end(), '\n'), 20) << result.output;
}

TEST(Commands, ViewWithoutItsServer) {
    const TemporaryFolder folder;
    const std::filesystem::path alone = folder / "claray";
    std::filesystem::copy_file(CLARAY_PROGRAM, alone);
    const ProcessResult result = run_process({alone.string(), "view", "cornell", "--port", "0", "--size", "16x16"});
    EXPECT_TRUE(failed_with(result, 1, "the web page cannot be served: claray-http.so"));
}

TEST(Commands, NoOpenClPlatformAtAll) {
    const Variables nothing = {{"OCL_ICD_VENDORS", "/nonexistent"}, {"OCL_ICD_FILENAMES", ""}};
    const TemporaryFolder folder;
    EXPECT_TRUE(
        failed_with(run_claray({"devices"}, nothing), 3, "no OpenCL platform on this machine; install a driver"));
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", (folder / "x.png").string()}, nothing), 3,
                            "no OpenCL platform on this machine"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_EQ(run_claray({"scenes"}, nothing).exit_code, 0);  // needs no device
}

}  // namespace
}  // namespace claray::test
