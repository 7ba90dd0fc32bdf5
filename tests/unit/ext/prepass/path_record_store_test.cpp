#include "ext/prepass/path_record_store.h"

#include <gtest/gtest.h>

#include <set>

#include "pbrt/core/parallel.h"

namespace {

using namespace ext;

const Bounds2i kPixels({10, 20}, {47, 31});
const int kWidth = kPixels.high.x - kPixels.low.x, kCount = int(kPixels.Area());

struct Record {
    int32_t x = 0, y = 0, sample = 0, vertex = -1;
    bool IsEmpty() const { return vertex < 0; }
    bool operator==(const Record &) const = default;
    std::optional<std::string> Validate() const {
        return IsEmpty() ? std::optional("a record has no vertex") : std::nullopt;
    }
};

/// Every path of samples [first, end) adds a record at each of three vertices, which identifies the path.
std::vector<Record> Collect(const RecordedPaths &paths, PathRecordStore<Record> &store, int first, int end,
                            bool backwards) {
    ParallelForEach(kCount, [&](int64_t i) {
        const int k = backwards ? kCount - 1 - int(i) : int(i);
        const Point2i pixel(kPixels.low.x + k % kWidth, kPixels.low.y + k / kWidth);
        for (int sample = first; sample < end; ++sample) {
            PathObserver::PathPlaces places = store.PlacesOf(paths.NumberOf(pixel, sample));
            for (int v = 0; v < 3; ++v) store.Add(places, {pixel.x, pixel.y, sample, v});
        }
    });
    std::vector<Record> all;
    for (const Record &r : store.Places())
        if (!r.IsEmpty()) all.push_back(r);
    return all;
}

TEST(PathRecordStore, EverySampleHasAPlaceOfItsOwn) {
    const RecordedPaths paths(kPixels, 4, 7, 1 << 20);
    PathRecordStore<Record> store;
    store.Begin(paths.Count(), 2);
    const std::vector<Record> all = Collect(paths, store, 0, 9, false);
    EXPECT_EQ(all.size(), size_t(kCount) * 3 * 2);
    for (const Record &r : all) {
        EXPECT_LT(r.vertex, 2) << "a path has room for two records only";
        EXPECT_TRUE(r.sample >= 4 && r.sample < 7) << "the record is not of the samples 4 to 6";
    }
}

TEST(PathRecordStore, TheOrderOfPathsAndThreadsDoesNotMatter) {
    const auto collect = [](int threads, bool backwards) {
        ThreadLimit limit(threads);
        const RecordedPaths paths(kPixels, 0, 2, 300);
        PathRecordStore<Record> store;
        store.Begin(paths.Count(), 1);
        return Collect(paths, store, 0, 2, backwards);
    };
    EXPECT_EQ(collect(1, false), collect(3, true));
}

TEST(PathRecordStore, PathsAreLeftOutEvenly) {
    for (size_t most : {20u, 100u, 300u, 500u}) {
        const RecordedPaths paths(kPixels, 0, 1, most);
        PathRecordStore<Record> store;
        store.Begin(paths.Count(), 1);
        const std::vector<Record> all = Collect(paths, store, 0, 1, false);
        EXPECT_LE(all.size(), most);
        EXPECT_GT(all.size(), most / 3);
        std::set<int> rows, columns;
        for (const Record &r : all) {
            rows.insert(r.y);
            columns.insert(r.x);
        }
        EXPECT_EQ(rows.size(), 11u) << most;
        EXPECT_GT(columns.size(), std::min<size_t>(most / 3, 30)) << most;
    }
}

TEST(PathRecordStore, PathsAreNumbersOfPixels) {
    for (size_t most : {20u, 300u, 5000u}) {
        const RecordedPaths paths(kPixels, 2, 5, most);
        for (int i = 0; i < kCount; ++i) {
            const Point2i pixel(kPixels.low.x + i % kWidth, kPixels.low.y + i / kWidth);
            const std::optional<size_t> path = paths.NumberOf(pixel, 3);
            if (!path) continue;
            EXPECT_LT(*path, paths.Count());
            EXPECT_EQ(paths.PixelOf(*path), pixel - kPixels.low);
        }
    }
}

TEST(PathRecordStore, ProcessesMergeTheirRecords) {
    const RecordedPaths paths(kPixels, 0, 4, 300);
    PathRecordStore<Record> one, first, second;
    for (auto *store : {&one, &first, &second}) store->Begin(paths.Count(), 3);
    const std::vector<Record> all = Collect(paths, one, 0, 4, false);
    Collect(paths, first, 0, 2, false);
    Collect(paths, second, 2, 4, true);
    StateWriter out;
    second.Extract(out);
    const std::string bytes = out.Joined();
    StateReader in(bytes, "records");
    first.Merge(in);
    EXPECT_EQ(std::vector<Record>(first.Places().begin(), first.Places().end()),
              std::vector<Record>(one.Places().begin(), one.Places().end()));
    EXPECT_TRUE(std::ranges::all_of(second.Places(), [](const Record &r) { return r.IsEmpty(); }));
    PathRecordStore<Record> other;
    other.Begin(paths.Count() + 1, 3);
    StateReader again(bytes, "records");
    EXPECT_THROW(other.Merge(again), UserError);
}

TEST(PathRecordStore, NothingIsRecordedAfterTheEnd) {
    const RecordedPaths paths(kPixels, 0, 1, 1000);
    PathRecordStore<Record> store;
    store.Begin(paths.Count(), 1);
    store.End();
    EXPECT_TRUE(Collect(paths, store, 0, 1, false).empty());
}

}  // namespace
