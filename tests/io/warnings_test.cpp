// What loaders say: how much, and how.
#include "claray/io.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::TemporaryFolder;

TEST(WarningsList, KeepsTwentyOfAKindAndCountsTheRest) {
    Warnings warnings;
    for (int i = 0; i < 1000; ++i) {
        warnings.push_back("line " + std::to_string(i) + ": 'word " + std::to_string(i) + "' is odd");
        if (i < 3) warnings.push_back("something else");
    }
    ASSERT_EQ(warnings.size(), 20u + 3 + 1);
    EXPECT_EQ(warnings[0], "line 0: 'word 0' is odd");
    EXPECT_EQ(warnings.back(), "and 980 more, the last: line 999: 'word 999' is odd");
}

TEST(WarningsList, HoldsLinesForATerminal) {
    const Warnings warnings = {"a\nb\x1b[31m\xff", std::string(5000, 'x') + "end"};
    EXPECT_EQ(warnings[0], "a?b?[31m?");
    EXPECT_LE(warnings[1].size(), 280u);
    EXPECT_TRUE(warnings[1].starts_with("xxx") && warnings[1].ends_with("xend")) << warnings[1];
}

/// Names and words of files that would write to the terminal, each in turn.
TEST(WarningsList, NothingOfAFileReachesTheTerminalAsItIs) {
    const TemporaryFolder folder;
    const std::string evil = "\x1b]0;x\x07\x9b\xc2\x9b\xe2\x80\xae\xff" + std::string(1000, 'y');
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", file = "e\x1b[2J\nvil.obj";
    static_cast<void>(
        folder.file("m.mtl", "newmtl a\nKd " + evil + "\nmap_Kd " + evil + "\nbump " + evil + "\n" + evil));
    const auto clean = [](const std::string& line) {
        return line.size() <= 280 && std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c < 0x7f; });
    };
    const std::string texts[] = {
        "mtllib m.mtl\n" + triangle + "usemtl a\nf 1 2 3\n",
        "mtllib " + evil + "\n" + triangle + "usemtl " + evil + "\ng " + evil + "\nf 1 2 3\n" + evil + "\n",
        triangle + "v " + evil + " 0 0\nf 1 2 3\n",
        triangle + "f 1 2 " + evil + "\n",
        evil,
    };
    for (const std::string& text : texts) {
        Warnings warnings;
        try {
            static_cast<void>(load_obj(folder.file(file, text), warnings));
        } catch (const Error& error) {
            EXPECT_TRUE(clean(error.what())) << testing::PrintToString(std::string(error.what()));
            EXPECT_NE(std::string(error.what()).find("vil.obj"), std::string::npos) << error.what();
        }
        for (const std::string& warning : warnings) EXPECT_TRUE(clean(warning)) << testing::PrintToString(warning);
    }
}

/// The scene is in the working folder, whose name is empty.
TEST(WarningsList, ErrorsNameTheFileAtFault) {
    const TemporaryFolder folder;
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder / "");
    static_cast<void>(folder.file("a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"));
    static_cast<void>(folder.file("m.mtl", "newmtl a\nmap_Kd ../x.png\n"));
    Warnings warnings;
    static_cast<void>(load_obj("a.obj", warnings));
    EXPECT_EQ(warnings.at(0).find("'a.obj': the file name '../x.png' leaves"), 0u) << warnings.at(0);
    static_cast<void>(
        folder.file("b.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":"../b.bin","byteLength":4}]})"));
    test::expect_error(ErrorKind::user, {"'b.gltf'", "'../b.bin' leaves"},
                       [&] { static_cast<void>(load_gltf("b.gltf", warnings)); });
    for (const char* uri : {"/etc/passwd", "%2e%2e/b.bin", "file:///etc/passwd"}) {
        static_cast<void>(folder.file("b.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + std::string(uri) +
                                                    R"(","byteLength":4}]})"));
        test::expect_error(ErrorKind::user, {"'b.gltf'"}, [&] { static_cast<void>(load_gltf("b.gltf", warnings)); });
    }
    std::filesystem::current_path(before);
}

}  // namespace
}  // namespace claray
