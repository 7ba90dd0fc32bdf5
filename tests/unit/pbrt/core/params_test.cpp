#include "pbrt/core/params.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/errors.h"
#include "support/given_params.h"
#include "support/param.h"

namespace pbrt {
namespace {

using test::FloatParam, test::IntParam;

TEST(ParamSet, NameAndTypeMustBothMatch) {
    ParamSet set("Shape \"s\"", {});
    set.Add(IntParam("x", {3}));
    EXPECT_EQ(set.Find("x", ParamType::Float), nullptr);
    EXPECT_EQ(set.Find("X", ParamType::Integer), nullptr);
    EXPECT_TRUE(set.Has("x"));
    ASSERT_NE(set.Find("x", ParamType::Integer), nullptr);
    EXPECT_EQ(set.Find("x", ParamType::Integer)->ints, (std::vector<int>{3}));
}

TEST(ParamSet, TheLastOfEqualOnesWinsAndOwnOnesBeatDefaults) {
    ParamSet set;
    set.Add(FloatParam("a", {1}));
    set.Add(FloatParam("a", {2}));
    set.AddDefault(FloatParam("a", {3}));
    set.AddDefault(FloatParam("b", {4}));
    set.AddDefault(FloatParam("b", {5}));
    EXPECT_EQ(set.Find("a", ParamType::Float)->floats[0], 2);
    EXPECT_EQ(set.Find("b", ParamType::Float)->floats[0], 5);
    EXPECT_TRUE(set.Find("b", ParamType::Float)->fromAttribute);
}

TEST(ParamSet, ErrorsNameTheEntityAndThePlace) {
    const ParamSet set = test::Params("Shape \"s\"", 1).Number("a", 1);
    const UserError error = set.Error("a", "is odd.");
    EXPECT_EQ(error.Diagnostics()[0].message, "Shape \"s\": is odd.");
    EXPECT_EQ(error.Diagnostics()[0].loc.line, 2);
    DiagnosticSink sink;
    set.Warn(sink, "b", "is missing.");
    EXPECT_EQ(sink.All()[0].message, "Shape \"s\": is missing.");
    EXPECT_EQ(sink.All()[0].loc.line, 1);
    EXPECT_FALSE(sink.HasErrors());
    EXPECT_EQ(set.LocOf("a").line, 2);
    EXPECT_EQ(set.LocOf("b").line, 1);
}

TEST(ParamSet, AtGivesErrorsWithoutAPlaceThatOfTheParameter) {
    auto file = std::make_shared<SourceFile>(SourceFile{"f", "text"});
    const ParamSet set("Shape \"s\"", {file, 7, 0});
    EXPECT_EQ(set.At("a", [] { return 3; }), 3);
    for (int line : {0, 4}) {
        const Diagnostic error = test::ErrorOf([&] {
            set.At("a", [&] { throw UserError("gone.", line ? FileLoc{file, line, 0} : FileLoc()); });
        });
        EXPECT_EQ(error.loc.line, line ? 4 : 7) << "an error that has a location keeps it";
        EXPECT_EQ(error.message, line ? "gone." : "Shape \"s\": gone.");
    }
}

TEST(ParamSet, RequireNamesTheRange) {
    const ParamSet set("Shape \"s\"", {});
    const Range<Float> range{0, 10, false, false, "mm"};
    test::ExpectError([&] { set.Require("x", 11.f, range); },
                      {"Shape \"s\"", "\"x\" is 11", "at least 0", "at most 10 mm"});
    EXPECT_NO_THROW(set.Require("x", 10.f, range));
    EXPECT_FALSE((Range<Float>{0, 1}.Contains(std::nanf(""))));
}

}  // namespace
}  // namespace pbrt
