#include "ext/octree/render_records.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pbrt/core/parallel.h"

namespace {

using namespace ext;

const Bounds2i kPixels({10, 20}, {47, 31});

/// Every path of samples [first, end) adds a record at each of three vertices; their position tells which path it was.
VisibilityRecords Collect(RenderRecords &records, int first, int end, bool backwards) {
    const int width = kPixels.high.x - kPixels.low.x, count = width * (kPixels.high.y - kPixels.low.y);
    ParallelForEach(count, [&](int64_t i) {
        const int k = backwards ? count - 1 - static_cast<int>(i) : static_cast<int>(i);
        const Point2i pixel(kPixels.low.x + k % width, kPixels.low.y + k / width);
        for (int sample = first; sample < end; ++sample) {
            PathObserver::PathPlaces path = records.BeginPath(pixel, sample);
            for (int v = 0; v < 3; ++v)
                records.Add(
                    path, Point3(static_cast<Float>(pixel.x), static_cast<Float>(pixel.y), static_cast<Float>(sample)),
                    false, {static_cast<uint32_t>(v), 1, 1, 1});
        }
    });
    VisibilityRecords all;
    records.AppendTo(&all, false);
    return all;
}

TEST(RenderRecords, EverySampleHasAPlaceOfItsOwn) {
    RenderRecords records;
    records.Begin(kPixels, 4, 7, 2, 1 << 20);
    const VisibilityRecords all = Collect(records, 0, 9, false);
    EXPECT_EQ(all.records.size(), static_cast<size_t>(kPixels.Area()) * 3 * 2);
    for (const VisibilityTry &t : all.tries) EXPECT_LT(t.light, 2u) << "a path has room for two records only";
    for (const VisibilityRecord &r : all.records)
        EXPECT_TRUE(r.p.z >= 4 && r.p.z < 7) << "the record is not of the samples 4 to 6";
}

TEST(RenderRecords, TheOrderOfPathsAndThreadsDoesNotMatter) {
    auto collect = [](int threads, bool backwards) {
        ThreadLimit limit(threads);
        RenderRecords records;
        records.Begin(kPixels, 0, 2, 1, 300);
        return Collect(records, 0, 2, backwards);
    };
    const VisibilityRecords one = collect(1, false), three = collect(3, true);
    ASSERT_EQ(one.records.size(), three.records.size());
    for (size_t i = 0; i < one.records.size(); ++i) EXPECT_EQ(one.records[i].p, three.records[i].p);
}

TEST(RenderRecords, WhatDoesNotFitIsLeftOutEvenly) {
    for (size_t most : {20u, 100u, 300u, 500u}) {
        RenderRecords records;
        records.Begin(kPixels, 0, 1, 1, most);
        const VisibilityRecords all = Collect(records, 0, 1, false);
        EXPECT_LE(all.records.size(), most);
        EXPECT_GT(all.records.size(), most / 3);
        std::set<float> rows, columns;
        for (const VisibilityRecord &r : all.records) {
            rows.insert(r.p.y);
            columns.insert(r.p.x);
        }
        EXPECT_EQ(rows.size(), 11u) << most;
        EXPECT_GT(columns.size(), std::min<size_t>(most / 3, 30)) << most;
    }
}

TEST(RenderRecords, SurfacesAndMediaAreKeptApart) {
    RenderRecords records;
    records.Begin(kPixels, 0, 1, 3, 100000);
    PathObserver::PathPlaces path = records.BeginPath(kPixels.low, 0);
    for (uint32_t v = 0; v < 3; ++v) records.Add(path, Point3(static_cast<Float>(v)), v == 1, {v, 1, 1, 1});
    VisibilityRecords surfaces, media;
    records.AppendTo(&surfaces, false);
    records.AppendTo(&media, true);
    ASSERT_EQ(surfaces.tries.size(), 2u);
    ASSERT_EQ(media.tries.size(), 1u);
    EXPECT_EQ(media.records[0].p, Point3(1));
}

TEST(RenderRecords, NothingIsTakenAfterTheEnd) {
    RenderRecords records;
    records.Begin(kPixels, 0, 1, 1, 1000);
    records.End();
    EXPECT_TRUE(Collect(records, 0, 1, false).records.empty());
}

}  // namespace
