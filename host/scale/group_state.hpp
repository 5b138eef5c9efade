// What a RenderGroup consists of.
#pragma once

#include "claray/scale/render_group.hpp"
#include "host/compute/state_of.hpp"
#include "host/render/checkpoint/checkpoint.hpp"
#include "host/scale/device_worker.hpp"

namespace claray {

struct RenderGroup::State {
    using Clock = std::chrono::steady_clock;
    using Progress = std::function<bool(const RenderProgress&)>;

    State(const std::vector<Device>& devices, const Scene& scene, const RenderConfig& config,
          std::function<void(const std::string&)> tell);

    /// A worker and the orders that it carries out.
    struct Member {
        std::unique_ptr<Worker> worker;
        DeviceWorker* device = nullptr;  // if it is one of this process
        bool is_ready = false, has_failed = false;
        std::uint32_t first_paths = 0, most_paths = 0;  // once it is ready
        double handover = 0;                            // likewise
        int number = -1;                                // of the dealer, once it takes orders
        std::deque<Order> orders = {};
        Clock::time_point since = {};  // when the first of these became the first
        std::string failure = {};
        [[nodiscard]] bool takes_orders() const { return number >= 0 && !has_failed; }
    };
    /// `make(inbox, number)` makes a worker that is not a device of this process. Call it before `render`.
    void add(const std::function<std::unique_ptr<Worker>(Inbox&, std::size_t)>& make);

    RenderProgress render(const Progress& progress);
    [[nodiscard]] DeviceWorker& lead();

    // Decisions.
    void begin_dealing();
    [[nodiscard]] bool has_targets() const { return config.noise > 0 || config.error > 0; }
    [[nodiscard]] std::uint32_t first_limit() const;
    [[nodiscard]] bool raise_limit();
    [[nodiscard]] bool time_is_up() const;
    [[nodiscard]] double seconds_left() const;

    // Orders and reports.
    [[nodiscard]] bool reach_limit(const Progress& progress);
    [[nodiscard]] bool show(const Progress& progress);
    void deal();
    void send(Member& member, const Order& order);
    void take_report(std::chrono::microseconds patience);
    [[nodiscard]] bool fits(const Member& member, const Report& report) const;
    void take_done(Member& member, Report& report);
    void join_dealing(Member& member);
    void expect_members();
    void drop(Member& member, const Report& report);
    void drop(std::size_t member, const std::string& why);
    void drop_silent();
    void wait_for_lead();
    void wait_for_orders(std::uint32_t first = 0, std::uint32_t pixels = ~0u);
    [[nodiscard]] std::size_t failures() const;
    [[nodiscard]] bool asked_for_sums() const;

    // Sums.
    void ask_for_sums(bool of_lead);
    void gather(bool of_lead);
    [[nodiscard]] bool fill_film();
    [[nodiscard]] RenderProgress hand_over();
    void keep_now_and_then();
    void save_checkpoint();

    const Scene& scene;
    RenderConfig config;
    std::function<void(const std::string&)> tell;
    RenderIdentity identity;
    Checkpoint start;  // from which the render continues
    GroupSums sums;    // of all pixels, as far as they were handed over
    Inbox inbox;
    std::vector<Member> members;  // after the inbox, to which they post until they end
    std::optional<Dealer> dealer;
    ErrorProgress error;  // of the last lead
    std::size_t led_by = 0, next_dealt = 0;
    std::optional<Clock::time_point> begin;
    RenderProgress measured;  // when the last decision was taken
    bool lead_has_begun = false;
    Clock::time_point last_shown, last_sums;
    bool keeps = false;    // sums were asked for
    bool hurries = false;  // the program was told to end
    std::string checkpoint_error;
    double most_seconds_of_order = 600;  // of a member that is elsewhere, else it is dropped
};

}  // namespace claray
