#include "host/cli/output/progress.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "tests/support/process.hpp"

namespace claray::cli {
namespace {

RenderProgress at(unsigned spp, double seconds, double noise = 0) {
    RenderProgress progress;
    progress.spp = spp;
    progress.seconds = seconds;
    progress.noise = noise;
    return progress;
}

RenderConfig hundred_samples() {
    RenderConfig config;
    config.spp = 100;
    return config;
}

TEST(Progress, WhateverEndsTheRenderFirstCounts) {
    RenderConfig config = hundred_samples();
    EXPECT_DOUBLE_EQ(fraction_done(at(25, 1), config), 0.25);
    config.seconds = 2;
    EXPECT_DOUBLE_EQ(fraction_done(at(25, 1), config), 0.5);
    config.noise = 0.09;  // noise 0.1 now: 0.81 of the samples that 0.09 takes
    EXPECT_NEAR(fraction_done(at(25, 1, 0.1), config), 0.81, 1e-12);
    EXPECT_DOUBLE_EQ(fraction_done(at(25, 9), config), 1.0);
    EXPECT_DOUBLE_EQ(fraction_done(at(0, 0), config), 0.0);
}

/// All that a display writes.
std::string written(ProgressStyle style, const std::vector<RenderProgress>& steps) {
    const test::TemporaryFolder folder;
    std::FILE* file = std::fopen((folder / "out").c_str(), "w");
    {
        ProgressDisplay display(hundred_samples(), style, file);
        for (const RenderProgress& step : steps) display.show(step);
        display.finish(steps.back());
    }
    std::fclose(file);
    return test::read_file(folder / "out");
}

/// Standard error is a terminal while it lives.
class Terminal {
public:
    Terminal() : main_(::posix_openpt(O_RDWR | O_NOCTTY)), before_(::dup(STDERR_FILENO)) {
        if (main_ < 0 || ::grantpt(main_) != 0 || ::unlockpt(main_) != 0) return;
        const int side = ::open(::ptsname(main_), O_RDWR | O_NOCTTY);
        ::dup2(side, STDERR_FILENO);
        ::close(side);
    }
    ~Terminal() {
        ::dup2(before_, STDERR_FILENO);
        ::close(before_);
        if (main_ >= 0) ::close(main_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

private:
    int main_, before_;
};

TEST(Progress, ABarIsForTerminalsThatEraseLines) {
    EXPECT_EQ(progress_style(true), ProgressStyle::none);
    std::vector<ProgressStyle> styles;
    {
        const Terminal terminal;
        if (::isatty(STDERR_FILENO) != 1) GTEST_SKIP() << "no terminals here";
        for (const char* name : {"xterm", "dumb", ""}) {
            const test::ScopedEnvironment term("TERM", name);
            styles.push_back(progress_style(false));
        }
    }
    EXPECT_EQ(styles, (std::vector{ProgressStyle::bar, ProgressStyle::lines, ProgressStyle::lines}));
}

/// nohup's: what it lets live goes on.
TEST(Progress, AnIgnoredHangupStaysIgnored) {
    struct sigaction now = {};
    std::signal(SIGHUP, SIG_IGN);
    {
        const InterruptGuard guard;
        std::raise(SIGHUP);
        EXPECT_FALSE(InterruptGuard::interrupted());
    }
    sigaction(SIGHUP, nullptr, &now);
    EXPECT_EQ(now.sa_handler, SIG_IGN);
    std::signal(SIGHUP, SIG_DFL);
    const InterruptGuard guard;
    std::raise(SIGHUP);
    EXPECT_TRUE(InterruptGuard::interrupted());
}

TEST(Progress, BarIsDrawnAgainOnOneLine) {
    const std::string text = written(ProgressStyle::bar, {at(10, 1), at(50, 5, 0.02), at(100, 10, 0.01)});
    EXPECT_NE(text.find("\r[===                           ]  10 %  10/100 spp, 9.0 s left"), std::string::npos) << text;
    EXPECT_NE(text.find("50/100 spp, 5.0 s left, noise 2.00 %"), std::string::npos) << text;
    EXPECT_NE(text.find("\r[==============================] 100 %  100/100 spp, noise 1.00 %"), std::string::npos)
        << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
    EXPECT_EQ(text.back(), '\n');
}

TEST(Progress, LinesComeNowAndThen) {
    const std::string text = written(ProgressStyle::lines, {at(1, 0.1), at(2, 0.2), at(30, 3), at(40, 4), at(60, 6)});
    EXPECT_EQ(text,
              "  1 %  1/100 spp, 9.9 s left\n"
              " 30 %  30/100 spp, 7.0 s left\n"
              " 60 %  60/100 spp, 4.0 s left\n"
              " 60 %  60/100 spp, 4.0 s left\n");
}

TEST(Progress, LongTimesHaveUnits) {
    const std::string text = written(ProgressStyle::lines, {at(1, 100), at(2, 12239)});
    EXPECT_NE(text.find("1/100 spp, 2.75 h left"), std::string::npos) << text;
    EXPECT_NE(text.find("2/100 spp, 6.941 days left"), std::string::npos) << text;
}

TEST(Progress, WaitingForKernelsIsSaidAtOnce) {
    RenderProgress waiting = at(2, 0.3, 0.1);
    waiting.waits_for_kernels = true;
    const std::string text = written(ProgressStyle::lines, {at(1, 0.1), at(2, 0.2), waiting, waiting, at(3, 2.5)});
    EXPECT_EQ(text,
              "  1 %  1/100 spp, 9.9 s left\n"
              "  2 %  2/100 spp, waiting for the scene's kernels\n"
              "  3 %  3/100 spp, 80.8 s left\n"
              "  3 %  3/100 spp, 80.8 s left\n");
}

TEST(Progress, TheTimeOfFramesIsThatOfAll) {
    double now = 5;
    FrameCount frames(10, [&] { return now; });
    EXPECT_EQ(frames.text(), "frame 1/10");
    EXPECT_DOUBLE_EQ(frames.seconds_left(0), 0) << "nothing tells";
    now = 8;  // half of the first frame in 3 s, 19 halves to go
    EXPECT_DOUBLE_EQ(frames.fraction(0.5), 0.05);
    EXPECT_DOUBLE_EQ(frames.seconds_left(0.5), 19 * 3);
    now = 25, frames.finish_one();  // it waited for kernels
    EXPECT_DOUBLE_EQ(frames.seconds_left(0), 9 * 20);
    now = 27, frames.finish_one();
    EXPECT_EQ(frames.text(), "frame 3/10");
    EXPECT_DOUBLE_EQ(frames.seconds_left(0), 8 * 2) << "2 s each since the first";
    now = 28;
    EXPECT_DOUBLE_EQ(frames.seconds_left(0.5), 7.5 * 2);
    EXPECT_DOUBLE_EQ(frames.fraction(0.5), 0.25);
    for (int i = 0; i < 8; ++i) frames.finish_one();
    EXPECT_DOUBLE_EQ(frames.fraction(1), 1);
    EXPECT_DOUBLE_EQ(frames.seconds_left(0), 0);
    EXPECT_EQ(frames.text(), "frame 10/10");
}

TEST(Progress, FramesShareTheirLines) {
    double now = 0;
    FrameCount frames(4, [&] { return now; });
    const auto display = [&](ProgressStyle style, const std::vector<double>& times) {
        const test::TemporaryFolder folder;
        std::FILE* file = std::fopen((folder / "out").c_str(), "w");
        for (const double end : times) {
            ProgressDisplay one(hundred_samples(), style, file, &frames);
            one.show(at(50, end - now)), now = end, one.finish(at(100, end - now));
            frames.finish_one();
        }
        std::fclose(file);
        return test::read_file(folder / "out");
    };
    EXPECT_EQ(display(ProgressStyle::lines, {1, 2.5}),
              " 12 %  frame 1/4, 50/100 spp\n"
              " 50 %  frame 2/4, 100/100 spp, 2.5 s left\n")
        << "one in two seconds";
    const std::string bar = display(ProgressStyle::bar, {4});
    EXPECT_NE(bar.find(" 62 %  frame 3/4, 50/100 spp, "), std::string::npos) << bar;
    EXPECT_TRUE(bar.ends_with("\r\x1b[K")) << "the next frame's takes its place";
}

TEST(Progress, QuietIsSilent) { EXPECT_EQ(written(ProgressStyle::none, {at(1, 1), at(100, 100)}), ""); }

TEST(Interrupts, OnlyTheFirstSignalIsCaught) {
    const InterruptGuard guard;
    EXPECT_FALSE(InterruptGuard::interrupted());
    std::raise(SIGINT);
    EXPECT_TRUE(InterruptGuard::interrupted());
    struct sigaction next = {};
    sigaction(SIGINT, nullptr, &next);
    EXPECT_EQ(next.sa_handler, SIG_DFL);
}

}  // namespace
}  // namespace claray::cli
