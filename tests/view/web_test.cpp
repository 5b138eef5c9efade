// The web page of the view, as a browser asks for it.
#include "host/view/web/web.hpp"

#include <gtest/gtest.h>
#include <httplib.h>

#include <future>
#include <thread>

#include "host/compute/memory.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using namespace view;

Scene one_sphere() {
    Scene scene;
    scene.materials.resize(1);
    scene.meshes = {sphere(2)};
    scene.lights = {point_light({0, 4, 3}, glm::vec3(30))};
    scene.camera = Camera{{0, 1, 8}, {0, 0, 0}, {0, 1, 0}, 45.f};
    return scene;
}

const ViewConfig web_config{.render = {.width = 24, .height = 16, .spp = 4, .max_depth = 4}, .picture = {}};

TEST(ViewWeb, ServesThisComputerOnly) {
    View view(device(), one_sphere(), web_config);
    std::promise<std::string> ready;
    WebConfig web{.port = 0, .goes_on = [] { return true; }};
    web.ready = [&](const std::string& url) { ready.set_value(url); };
    auto served = std::async(std::launch::async, [&] { serve(view, web); });
    const std::string url = ready.get_future().get();
    const int port = std::stoi(url.substr(url.rfind(':') + 1));
    httplib::Client client("127.0.0.1", port);
    const auto status_of = [](const httplib::Result& result) { return result ? result->status : 0; };
    const auto start = client.Get("/");
    EXPECT_EQ(status_of(start), 200);
    for (const char* part : {"\"ArrowLeft\": \"orbit -5 0\"", "<option>error", "drag: orbit", "degreesPerPixel = 0.4"})
        EXPECT_NE(start->body.find(part), std::string::npos) << part;
    EXPECT_EQ(start->body.find('@'), std::string::npos);
    EXPECT_EQ(status_of(client.Get("/", {{"Host", "evil.example"}})), 403);
    EXPECT_EQ(status_of(client.Post("/command", {{"Origin", "http://evil.example"}}, "home", "text/plain")), 403);
    EXPECT_EQ(status_of(client.Post("/command", "jump", "text/plain")), 400);
    EXPECT_EQ(status_of(client.Post("/command", "save x.png", "text/plain")), 403);
    const auto next_jpeg = [&] {
        std::string body;
        client.Get("/stream", [&](const char* data, std::size_t size) {
            body.append(data, size);
            return body.size() < 600;
        });
        const std::size_t begin = body.find("\r\n\r\n");
        return begin == std::string::npos ? body : body.substr(begin + 4);
    };
    while (client.Get("/status")->body.find("4 samples") == std::string::npos) std::this_thread::yield();
    const std::string jpeg = next_jpeg();
    EXPECT_TRUE(jpeg.starts_with("\xff\xd8"));
    EXPECT_TRUE(next_jpeg().starts_with("\xff\xd8")) << "after a connection that was cut off";
    const auto picture = client.Get("/picture.png");
    EXPECT_EQ(status_of(picture), 200);
    EXPECT_TRUE(picture->body.starts_with("\x89PNG"));
    EXPECT_EQ(status_of(client.Post("/command", "resize 10 8", "text/plain")), 200);
    while (client.Get("/status")->body.find("10x8, 4 samples") == std::string::npos) std::this_thread::yield();
    View other(device(), one_sphere(), web_config);
    EXPECT_TRUE(throws_error(ErrorKind::user, "cannot listen",
                             [&] { serve(other, {.port = port, .goes_on = [] { return false; }}); }));
    EXPECT_EQ(status_of(client.Post("/command", "quit", "text/plain")), 200);
    served.get();
}

TEST(ViewWeb, ALostDeviceEndsTheServer) {
    View view(device(), one_sphere(), web_config);
    WebConfig web{.port = 0, .goes_on = [] { return true; }};
    web.ready = [&](const std::string&) { fail_command(device(), 2); };
    EXPECT_TRUE(throws_error(ErrorKind::device, "cannot run the kernel", [&] { serve(view, web); }));
    fail_command(device(), 0);
}

}  // namespace
}  // namespace claray::test
