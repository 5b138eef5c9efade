// Decides which worker renders which pixels and samples next.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "claray/shared/path.h"

namespace claray {

/// What a worker is to do. Each worker carries out its orders one after the other.
struct Order {
    enum class Kind : std::uint32_t {
        render,  ///< add the samples of `batch` to its pixels
        read,    ///< report the sums of these pixels
        give     ///< the same; the worker no longer holds the pixels
    };
    Kind kind = Kind::render;
    Batch batch = {};
    bool brings_sums = false;  ///< of `render`: the sums so far of these pixels come with the order
};

/// Pixels with equal numbers of samples.
struct PixelRun {
    std::uint32_t first = 0, pixels = 0, samples = 0;
};

/// The image is divided into bands of consecutive pixels. A worker that has rendered samples of a band holds its sums
/// and goes on with it, so that the samples of a pixel are added in their order and seldom move. A worker that is ahead
/// of another one takes bands over from it, as many as its measured speed is worth; they are its own from then on, so
/// that it does not ask twice. A worker's first piece measures its speed. The others take about 0.1 s, a third of the
/// remaining time near the end, and at most a quarter of the time so far until each worker has its share.
class Dealer {
public:
    /// `runs` cover all pixels of the image; the caller knows the sums of those that have samples. Passes grow as in
    /// PassSchedule, up to `largest_pass` samples per pixel. `bands`: about this many.
    Dealer(const std::vector<PixelRun>& runs, std::uint32_t largest_pass, std::uint32_t bands = 4096);

    /// Adds a worker and returns its number. Its first piece has `first_paths` paths, and none has more than
    /// `most_paths`; if both are equal, all have as many. `handover`: seconds to hand over the sums of a pixel in the
    /// end; the worker gets work only if that ends the render sooner. There must be a worker for which it is 0.
    int add(std::uint32_t first_paths, std::uint32_t most_paths, double handover = 0);
    /// The number of workers that will be added in all. Until then pieces at the beginning are shorter.
    void expect(unsigned workers) { expected_ = workers; }
    /// No pixel gets more samples than this; never less than before.
    void set_limit(std::uint32_t samples);
    /// The next order for a worker; none if it has to wait for others. `seconds_left`: pieces take at most half of it.
    [[nodiscard]] std::optional<Order> next(int worker, double seconds_left);
    /// An order for the sums of pixels that the worker has brought to the limit and the caller does not know; none if
    /// there are none. For a worker that `next` gave nothing to do.
    [[nodiscard]] std::optional<Order> read_finished(int worker);
    /// Orders for the sums of all pixels that this worker holds and the caller does not know.
    [[nodiscard]] std::vector<Order> handovers(int worker);
    /// Must be called for each order of a worker when it is done, in order. The caller keeps the sums of `read` and
    /// `give`. `seconds`: since its order before was done, or since this one was sent.
    void done(int worker, const Order& order, double seconds);
    /// The worker is gone with the sums that it held. What the caller does not know is rendered again.
    void lost(int worker);

    /// Every pixel has as many samples as the limit allows.
    [[nodiscard]] bool finished() const { return done_ == std::uint64_t(pixels_) * limit_; }
    /// Samples of all pixels that are done.
    [[nodiscard]] std::uint64_t samples() const { return done_; }
    /// Samples that every pixel has.
    [[nodiscard]] std::uint32_t least() const;
    /// The least number of samples from `samples` on with which a pass ends; it may exceed the limit.
    [[nodiscard]] std::uint32_t end_of_pass(std::uint32_t samples) const;
    [[nodiscard]] std::uint32_t limit() const { return limit_; }
    /// The samples that are done, and those in the sums that the caller knows.
    [[nodiscard]] std::vector<PixelRun> rendered() const { return runs(&Band::done); }
    [[nodiscard]] std::vector<PixelRun> known() const { return runs(&Band::known); }
    /// Pixels with samples whose sums this worker lacks: another one holds them, or the caller.
    [[nodiscard]] std::vector<PixelRun> held_by_others(int worker) const;
    /// Measured samples per second; 0: unknown.
    [[nodiscard]] double speed(int worker) const { return workers_[std::size_t(worker)].speed(); }
    /// Samples of this worker, including those that were lost with it.
    [[nodiscard]] std::uint64_t samples_of(int worker) const { return workers_[std::size_t(worker)].all; }

private:
    static constexpr int nobody = -1;
    using Index = std::uint32_t;  // of a band
    struct Band {
        std::uint32_t first, pixels;
        std::uint32_t ordered, done, known;  // samples per pixel: ordered, rendered, in the sums that the caller knows
        int holder = nobody;
        int taker = nobody;    // to whom it leaves
        bool leaves = false;   // the holder is to give it
        bool is_away = false;  // the caller has its sums, and not yet the holder
    };
    /// Bands of equal numbers of samples that nobody holds, as runs of neighbours.
    class Runs {
    public:
        void add(Index band);
        void remove(Index band);
        [[nodiscard]] bool contains(Index band) const;
        /// First and end of the longest.
        [[nodiscard]] std::pair<Index, Index> longest() const;
        [[nodiscard]] bool empty() const { return ends_.empty(); }

    private:
        void put(Index first, Index end);
        std::map<Index, Index>::iterator take(std::map<Index, Index>::iterator run);
        std::map<Index, Index> ends_;                  // of runs, by their first
        std::set<std::pair<Index, Index>> by_length_;  // length, and minus the first: the first of equal ones is last
    };
    struct Worker {
        std::uint32_t first_paths, most_paths;
        double handover;
        std::uint32_t last_paths = 0;
        double samples = 0, seconds = 0;  // recent ones
        std::uint64_t all = 0;
        std::deque<Order> gives = {};     // to be sent
        std::deque<Index> finished = {};  // bands that reached the limit; some have left or are known since
        unsigned giving = 0;              // sent or to be sent
        Index next_band = 0;              // behind its last piece
        bool is_lost = false;
        // Bands that it holds and that do not leave.
        std::set<Index> bands = {};
        std::set<std::pair<std::uint32_t, Index>> by_samples = {};  // ordered ones, below the limit
        std::uint64_t pixels = 0, ordered = 0;                      // of these; samples of all their pixels
        std::uint64_t coming_pixels = 0, coming_ordered = 0;        // of bands that others are to give to it
        double seconds_left = -1;                                   // its key in by_seconds_; negative: it is not there
        [[nodiscard]] double speed() const { return seconds > 0 ? samples / seconds : 0; }
    };

    [[nodiscard]] std::vector<PixelRun> runs(std::uint32_t Band::*samples) const;
    [[nodiscard]] bool may_render(const Band& band, int worker) const {
        return band.ordered < limit_ && !band.leaves && (band.holder == worker || band.holder == nobody);
    }
    /// Changes a band and keeps the indices below.
    template <class Change>
    void change(Index band, const Change& change);
    void enter(Index band);
    void leave(Index band);
    [[nodiscard]] bool pays(const Worker& worker, double seconds_left) const;
    [[nodiscard]] Index first_band_for(int worker) const;
    [[nodiscard]] Index free_band_for(int worker, std::uint32_t samples) const;
    [[nodiscard]] std::uint32_t least_ordered() const { return ordered_counts_.begin()->first; }
    [[nodiscard]] double samples_left(const Worker& worker) const {
        return double(worker.pixels + worker.coming_pixels) * limit_ - double(worker.ordered + worker.coming_ordered);
    }
    [[nodiscard]] double seconds_to_end(const Worker& worker) const;
    [[nodiscard]] double paths_of_piece(const Worker& worker, double seconds_left);
    /// How many of the free pixels the worker may take.
    [[nodiscard]] std::uint32_t share_of_free(const Worker& worker) const;
    [[nodiscard]] std::uint32_t equal_share_left(const Worker& worker) const;
    [[nodiscard]] bool all_have_shares();
    [[nodiscard]] bool begins() const;
    [[nodiscard]] double seconds_so_far() const;
    [[nodiscard]] double seconds_to_limit() const;
    [[nodiscard]] std::uint32_t longer(const Batch& piece, double paths) const;
    [[nodiscard]] Order piece_from(Index band, int worker, double paths);
    void sort_in(int worker);
    void ask_others(int worker, std::uint32_t samples);
    void ask(int holder, int taker, double samples);
    void order_to_give(Index band, int taker);
    /// Calls visit(index) for each band of a batch.
    template <class Visit>
    void for_bands_of(const Batch& batch, const Visit& visit);

    std::uint32_t pixels_ = 0, largest_pass_, limit_ = 0;
    std::uint64_t ordered_ = 0, done_ = 0;  // samples of all pixels
    std::uint64_t done_before_ = 0;         // that the caller had at first
    double speed_ = 0;                      // of all workers
    std::uint32_t free_pixels_ = 0;         // that nobody holds
    unsigned without_bands_ = 0;            // workers that hold none
    unsigned measured_ = 0, at_work_ = 0;   // workers whose speed is known, and that have had an order
    unsigned expected_ = 0;                 // workers
    bool all_had_shares_ = false;
    std::vector<Band> bands_;
    std::vector<Worker> workers_;
    std::set<std::pair<double, int>> by_seconds_;  // workers that may be asked for bands, by their time up to the limit
    // Indices of the bands, so that an order takes no time for those that it does not concern.
    std::map<std::uint32_t, Runs> free_;                           // by samples
    std::map<std::uint32_t, Index> ordered_counts_, done_counts_;  // bands, by samples
};

}  // namespace claray
