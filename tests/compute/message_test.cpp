#include "host/base/message.hpp"

#include <gtest/gtest.h>

#include "claray/error.hpp"

namespace claray {
namespace {

TEST(Message, IsOneLineOfUtf8WithoutControls) {
    EXPECT_EQ(one_line("plain"), "plain");
    EXPECT_EQ(one_line("a\r\nb\tc\x1b[0m\x7f"), "a??b?c?[0m?");
    EXPECT_EQ(one_line("\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80"), "\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80");
    for (const char* broken : {"\xff", "\xc3", "\x80", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"})
        EXPECT_EQ(one_line(broken), std::string(std::string_view(broken).size(), '?'));
    EXPECT_EQ(one_line("\xc2\x9b"), "?") << "a control sequence in one character of Latin-1";
    EXPECT_EQ(one_line("a\xe2\x80\xae"
                       "b\xe2\x80\xa8"
                       "c\xe2\x81\xa6"),
              "a?b?c?")
        << "direction and line breaks";
    EXPECT_EQ(one_line(std::string("a\0b", 3)), "a?b");
}

TEST(Message, LosesItsMiddleWhereItIsTooLong) {
    for (const std::size_t size : {281u, 1000u, 10'000'000u}) {
        const std::string text = one_line("begin" + std::string(size, 'm') + "end");
        EXPECT_EQ(text.size(), longest_message);
        EXPECT_TRUE(text.starts_with("beginm") && text.ends_with("mend") && text.find("m...m") != std::string::npos);
    }
    EXPECT_EQ(one_line(std::string(280, 'm')), std::string(280, 'm'));
    std::string euros;
    for (int i = 0; i < 100; ++i) euros += "\xe2\x82\xac";
    for (const char* begin : {"", "a", "ab"})
        for (const char* end : {"", "y", "yz"}) {
            const std::string cut = one_line(begin + euros + end);
            EXPECT_LE(cut.size(), longest_message);
            EXPECT_EQ(one_line(cut), cut) << "no character is cut in two";
        }
}

TEST(Message, OfAnErrorIsClean) {
    EXPECT_STREQ(Error(ErrorKind::user, "'a\nb': bad", "mend\x1bit").what(), "'a?b': bad; mend?it");
    const Error error(ErrorKind::device, "first\nline", {},
                      "log:\n\tx\x1b"
                      "y\n");
    EXPECT_STREQ(error.what(), "first?line\nlog:\n\tx?y\n");
}

}  // namespace
}  // namespace claray
