#include "pbrt/core/describe.h"

#include <gtest/gtest.h>

namespace pbrt {
namespace {

struct Sample {
    int leaves = 4096;
    Float floor = 0.5f;
    bool prepass = true;
    template <class V>
    void Describe(V &&v) {
        v("leaves", leaves, Range{1, 10000}, "how many");
        v("floor", floor, Range{0.f, 1.f}, "least share");
        v("prepass", prepass, "collect first");
    }
};

Param Make(ParamType type, const std::string &name) {
    Param p;
    p.type = type;
    p.name = name;
    return p;
}

TEST(Describe, OneListingDocumentsAndPrints) {
    std::vector<ParamDoc> docs = DocumentParams<Sample>();
    ASSERT_EQ(docs.size(), 3u);
    EXPECT_EQ(docs[0].name + " " + docs[0].type + " " + docs[0].defaultValue + " " + docs[0].range + " " + docs[0].help,
              "leaves integer 4096 1 to 10000 how many");
    EXPECT_EQ(docs[1].type + " " + docs[1].defaultValue, "float 0.5");
    EXPECT_EQ(docs[2].type + " " + docs[2].defaultValue, "bool true");
    EXPECT_EQ(EffectiveParams(Sample{7, 0.25f, false}).dump(), "{\"leaves\":7,\"floor\":0.25,\"prepass\":false}");
}

TEST(Describe, ReadsPrefixedParameters) {
    ParamSet set;
    Param leaves = Make(ParamType::Integer, "octree.leaves"), prepass = Make(ParamType::Bool, "octree.prepass");
    leaves.ints = {12};
    prepass.bools = {0};
    set.Add(leaves);
    set.Add(prepass);
    Sample sample;
    ReadParams(sample, set, "octree");
    EXPECT_EQ(sample.leaves, 12);
    EXPECT_EQ(sample.floor, 0.5f);
    EXPECT_FALSE(sample.prepass);
    DiagnosticSink sink;
    set.ReportUnused(sink);
    EXPECT_FALSE(sink.HasErrors());
}

TEST(Describe, OutOfRangeIsAnErrorAtTheParameter) {
    for (Float value : {-0.1f, 1.5f, std::numeric_limits<Float>::quiet_NaN()}) {
        ParamSet set;
        Param floor = Make(ParamType::Float, "octree.floor");
        floor.floats = {value};
        floor.loc = {std::make_shared<SourceFile>(SourceFile{"f", "text"}), 1, 3};
        set.Add(floor);
        Sample sample;
        try {
            ReadParams(sample, set, "octree");
            FAIL() << value;
        } catch (const UserError &e) {
            EXPECT_EQ(e.Diagnostics()[0].loc.column, 3);
            EXPECT_NE(std::string(e.what()).find("from 0 to 1"), std::string::npos) << e.what();
        }
    }
}

}  // namespace
}  // namespace pbrt
