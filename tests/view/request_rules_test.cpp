// Which requests the web page of the view answers.
#include "host/view/http/request_rules.hpp"

#include <gtest/gtest.h>
#include <httplib.h>

#include "host/view/http/http.hpp"

namespace claray::test {
namespace {

using namespace view;

struct Asked {
    httplib::Headers headers = {};
    std::string method = "GET", path = "/status", served = "127.0.0.1";
    bool framed = false;
};

/// The status of the refusal; 0: it is answered.
int refused(const Asked& asked) {
    httplib::Request request;
    request.method = asked.method, request.path = asked.path, request.headers = asked.headers;
    if (!request.has_header("Host")) request.set_header("Host", "localhost:8080");
    const std::optional<Refusal> refusal = refusal_of(request, {.host = asked.served, .framed = asked.framed});
    return refusal ? refusal->status : 0;
}

int refused_host(const std::string& host, const std::string& served = "127.0.0.1") {
    return refused({.headers = {{"Host", host}}, .served = served});
}

TEST(RequestRules, TheHostIsExactAndOfAnyCase) {
    for (const char* own : {"127.0.0.1", "127.0.0.1:8080", "localhost", "LocalHost:1", "[::1]:8080", "localhost:"})
        EXPECT_EQ(refused_host(own), 0) << own;
    for (const char* other :
         {"", "evil.example", "127.0.0.1:8080@evil", "127.0.0.1@evil", "localhost.evil.example", "localhost:80:80",
          "localhost:8o", "[::1", "[::1]evil", "[::2]", "127.0.0.11", "0.0.0.0", "local host", "localhost/x"})
        EXPECT_EQ(refused_host(other), 403) << other;
    EXPECT_EQ(refused({.headers = {{"Host", "localhost"}, {"Host", "evil.example"}}}), 403);
    EXPECT_EQ(refused_host("Box.example:80", "box.EXAMPLE"), 0);
    EXPECT_EQ(refused_host("localhost", "box.example"), 403);
    EXPECT_EQ(refused_host("[FE80::1]:80", "fe80::1"), 0);
    for (const char* all : {"0.0.0.0", "::"}) {
        EXPECT_EQ(refused_host("any.example:80", all), 0);
        EXPECT_EQ(refused_host("any.example:80@evil", all), 403);
    }
    EXPECT_EQ(url_host("FE80::1"), "[fe80::1]");
}

TEST(RequestRules, PagesOfOtherSitesAreRefused) {
    for (const char* origin : {"http://evil.example", "null", "https://localhost:8080", "http://localhost:8081"})
        EXPECT_EQ(refused({.headers = {{"Origin", origin}}}), 403) << origin;
    EXPECT_EQ(refused({.headers = {{"Origin", "http://LOCALHOST:8080"}}}), 0);
    for (const char* path : {"/", "/stream", "/frame", "/picture.png", "/status"}) {
        for (const char* site : {"cross-site", "same-site"})
            EXPECT_EQ(refused({.headers = {{"Sec-Fetch-Site", site}}, .path = path}), 403) << site << " " << path;
        for (const char* site : {"same-origin", "none"})
            EXPECT_EQ(refused({.headers = {{"Sec-Fetch-Site", site}}, .path = path}), 0) << site << " " << path;
    }
    httplib::Headers link = {
        {"Sec-Fetch-Site", "cross-site"}, {"Sec-Fetch-Mode", "navigate"}, {"Sec-Fetch-Dest", "document"}};
    EXPECT_EQ(refused({.headers = link, .path = "/"}), 0);
    EXPECT_EQ(refused({.headers = link, .path = "/picture.png"}), 403);
    link.erase("Sec-Fetch-Dest"), link.emplace("Sec-Fetch-Dest", "iframe");
    EXPECT_EQ(refused({.headers = link, .path = "/"}), 403);
    EXPECT_EQ(refused({.headers = link, .path = "/", .framed = true}), 0);
    EXPECT_EQ(refused({.headers = link, .path = "/picture.png", .framed = true}), 403);
}

TEST(RequestRules, BodiesAreShortPlainAndOfKnownLength) {
    const auto posted = [](const httplib::Headers& headers) {
        return refused({.headers = headers, .method = "POST", .path = "/command"});
    };
    EXPECT_EQ(posted({{"Content-Length", "0"}}), 0);
    EXPECT_EQ(posted({{"Content-Length", std::to_string(longest_body)}}), 0);
    EXPECT_EQ(posted({{"Content-Length", std::to_string(longest_body + 1)}}), 413);
    EXPECT_EQ(posted({{"Content-Length", "99999999999999999999999999"}}), 413);
    for (const char* length : {"", "-1", "4x", " 4", "0x4"}) EXPECT_EQ(posted({{"Content-Length", length}}), 400);
    EXPECT_EQ(posted({}), 411);
    EXPECT_EQ(posted({{"Content-Length", "4"}, {"Content-Length", "5"}}), 411);
    EXPECT_EQ(posted({{"Content-Length", "4"}, {"Transfer-Encoding", "chunked"}}), 411);
    for (const char* encoding : {"gzip", "br", "deflate", "identity"})
        EXPECT_EQ(posted({{"Content-Length", "4"}, {"Content-Encoding", encoding}}), 415) << encoding;
    EXPECT_EQ(refused({.headers = {{"Content-Length", "0"}}}), 0);
    EXPECT_EQ(refused({.headers = {{"Content-Length", "1"}}}), 400);
    EXPECT_EQ(refused({.headers = {{"Transfer-Encoding", "chunked"}}}), 411);
    EXPECT_EQ(refused({.method = "HEAD"}), 0);
    for (const char* method : {"PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH", "PRI"})
        EXPECT_EQ(refused({.method = method}), 405) << method;
}

TEST(RequestRules, PiecesOfFilesAreLonger) {
    const auto posted = [](const char* path, std::size_t length) {
        return refused({.headers = {{"Content-Length", std::to_string(length)}}, .method = "POST", .path = path});
    };
    EXPECT_EQ(posted("/upload", longest_piece), 0);
    EXPECT_EQ(posted("/upload", longest_piece + 1), 413);
    EXPECT_EQ(posted("/open", longest_body + 1), 413);
}

TEST(RequestRules, ATokenIsNeededIfThereIsOne) {
    const std::string token = "0123456789abcdef";
    const auto ask = [&](const std::string& path, const httplib::Headers& headers = {}) {
        httplib::Request request;
        request.method = "GET", request.path = path, request.headers = headers;
        request.set_header("Host", "127.0.0.1");
        take_token(request, token);
        const std::optional<Refusal> refusal = refusal_of(request, {.host = "127.0.0.1", .token = token});
        return refusal ? std::to_string(refusal->status) : request.path;
    };
    EXPECT_EQ(ask("/status"), "401");
    EXPECT_EQ(ask("/" + token + "/status"), "/status");
    EXPECT_EQ(ask("/" + token + "/"), "/");
    EXPECT_EQ(ask("/" + token + "/" + token + "/"), "/" + token + "/");
    for (const char* other : {"0123456789abcde", "0123456789abcdef0", "0123456789abcdeF", ""})
        EXPECT_EQ(ask("/" + std::string(other) + "/status"), "401") << other;
    EXPECT_EQ(ask("/" + token), "401");
    EXPECT_EQ(ask("/status", {{"Authorization", "Bearer " + token}}), "/status");
    EXPECT_EQ(ask("/status", {{"Authorization", token}}), "401");
    EXPECT_EQ(ask("/" + token + "/status", {{"Authorization", "Bearer other"}}), "/status");
    httplib::Request open;
    open.path = "/x/status";
    take_token(open, "");
    EXPECT_EQ(open.path, "/x/status");
}

}  // namespace
}  // namespace claray::test
