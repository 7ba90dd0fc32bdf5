#include "pbrt/lights/light_names.h"

#include <gtest/gtest.h>

namespace pbrt {
namespace {

const std::string kArea = "AreaLightSource \"diffuse\"";
FileLoc At(const std::shared_ptr<SourceFile> &file, int line) { return {file, line, 0}; }

TEST(LightNames, AreWhereTheLightStands) {
    auto room = std::make_shared<SourceFile>(SourceFile{"scenes/house/room.pbrt", "text"}),
         lamp = std::make_shared<SourceFile>(SourceFile{"lamp.pbrt", ""});
    LightNames names;
    names.Add(12, kArea, At(room, 123), At(room, 125), "triangle");
    names.Add(1, kArea, At(room, 123), At(lamp, 7), "sphere");
    names.Add(0, kArea, At(room, 1), At(room, 2), "triangle");
    names.Add(2, kArea, At(lamp, 3), At(lamp, 4), "patch");
    names.Add(1, "LightSource \"point\"", At(room, 200));
    EXPECT_EQ(names.Size(), 16u);
    EXPECT_EQ(names.NameOf(LightId(0u)), kArea + " at room.pbrt:123, shape at :125, triangle 1 of 12");
    EXPECT_EQ(names.NameOf(LightId(11u)), kArea + " at room.pbrt:123, shape at :125, triangle 12 of 12");
    EXPECT_EQ(names.NameOf(LightId(0u), 12), kArea + " at room.pbrt:123, shape at :125, 12 triangles");
    EXPECT_EQ(names.NameOf(LightId(12u)), kArea + " at room.pbrt:123, shape at lamp.pbrt:7");
    EXPECT_EQ(names.NameOf(LightId(13u), 2), kArea + " at lamp.pbrt:3, shape at :4, 2 patches");
    EXPECT_EQ(names.NameOf(LightId(15u)), "LightSource \"point\" at room.pbrt:200");
    EXPECT_EQ(names.NameOf(LightId(16u)), "");
    EXPECT_EQ(names.NameOf(LightId()), "");
    // The names do not keep the text of the file in memory.
    EXPECT_EQ(room.use_count(), 1);
    EXPECT_EQ(lamp.use_count(), 1);
}

TEST(LightNames, ManyLightsOfOneDirectiveAreOneEntry) {
    auto file = std::make_shared<SourceFile>(SourceFile{"many.pbrt", ""});
    LightNames names;
    names.Add(1000000, kArea, At(file, 1), At(file, 2), "triangle");
    EXPECT_EQ(names.EntryCount(), 1u);
    EXPECT_EQ(names.NameOf(LightId(999999u)), kArea + " at many.pbrt:1, shape at :2, triangle 1000000 of 1000000");
}

}  // namespace
}  // namespace pbrt
