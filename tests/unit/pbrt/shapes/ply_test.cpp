#include "pbrt/shapes/mesh_sources.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "shape_cases.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

constexpr const char *kHeader =
    "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
    "property double s\nproperty float t\nproperty uchar red\nelement face 3\n"
    "property list uchar int vertex_indices\nproperty int face_indices\nelement edge 1\nproperty int "
    "vertex1\nend_header\n";

std::string Ascii() {
    return std::string("ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\n") + kHeader +
           "0 0 0 0 0 1 0 0 255\n1 0 0 0 0 1 1 0 255\r\n1 1 0.5 0 0 1 1 1 1\n  0 1 -2.5e-1 0 0 1 0 1 9\n"
           "3 0 1 2 7\n4 0 1 2 3 8\n5 0 1 2 3 0 9\n4\n";
}

template <class T>
void Put(std::string &out, T value, bool big) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big == (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof(T));
    out.append(raw, sizeof(T));
}

std::string Binary(bool big) {
    std::string s =
        std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\nelement vertex 4\n" + kHeader;
    const float v[4][8] = {
        {0, 0, 0, 0, 0, 1, 0, 0}, {1, 0, 0, 0, 0, 1, 1, 0}, {1, 1, 0.5f, 0, 0, 1, 1, 1}, {0, 1, -0.25f, 0, 0, 1, 0, 1}};
    for (const auto &row : v) {
        for (int k = 0; k < 6; ++k) Put(s, row[k], big);
        Put(s, double(row[6]), big);
        Put(s, row[7], big);
        s += '\x7f';
    }
    const std::vector<std::vector<int>> faces = {{0, 1, 2}, {0, 1, 2, 3}, {0, 1, 2, 3, 0}};
    for (size_t f = 0; f < faces.size(); ++f) {
        s += char(faces[f].size());
        for (int i : faces[f]) Put(s, int32_t(i), big);
        Put(s, int32_t(7 + f), big);
    }
    Put(s, int32_t(4), big);
    return s;
}

void CheckMesh(const PlyMesh &m) {
    EXPECT_EQ(m.triangles.indices, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(m.quads.indices, (std::vector<uint32_t>{0, 1, 3, 2}));
    EXPECT_EQ(m.ignoredFaces, 1u);
    for (const MeshData *d : {&m.triangles, &m.quads}) {
        ASSERT_EQ(d->p.size(), 4u);
        EXPECT_EQ(d->p[2], Point3(1, 1, 0.5f));
        EXPECT_EQ(d->p[3], Point3(0, 1, -0.25f));
        ASSERT_EQ(d->n.size(), 4u);
        EXPECT_EQ(d->n[1], Normal3(0, 0, 1));
        ASSERT_EQ(d->uv.size(), 4u);
        EXPECT_EQ(d->uv[3], Point2(0, 1));
    }
}

TEST(Ply, AsciiAndBothByteOrdersGiveTheSameMesh) {
    CheckMesh(ParsePly(Ascii(), "a.ply"));
    CheckMesh(ParsePly(Binary(false), "l.ply"));
    CheckMesh(ParsePly(Binary(true), "b.ply"));
}

/// A triangle whose vertices have these float properties after x, y and z, with the values 1, 2, 3, ... at each.
PlyMesh WithProperties(const std::vector<std::string> &names) {
    std::vector<std::string> all = {"x", "y", "z"};
    std::string values;
    for (const std::string &name : names) {
        all.push_back(name);
        values += fmt::format(" {}", all.size() - 3);
    }
    values += '\n';
    return ParsePly(PlyText(3, all, 1, "0 0 0" + values + "1 0 0" + values + "0 1 0" + values + "3 0 1 2\n"), "a.ply");
}

TEST(Ply, FirstCompletePairOfTextureCoordinatesIsUsed) {
    auto uv = [](const std::vector<std::string> &names) { return WithProperties(names).triangles.uv; };
    for (auto [u, v] : {std::pair("u", "v"), {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}})
        EXPECT_EQ(uv({u, v}), std::vector<Point2>(3, Point2(1, 2))) << u;
    EXPECT_EQ(uv({"u", "v", "s", "t"}).at(0), Point2(1, 2));
    EXPECT_EQ(uv({"s", "t", "u", "v"}).at(0), Point2(3, 4));
    EXPECT_EQ(uv({"texture_s", "texture_t", "texture_v", "texture_u"}).at(0), Point2(4, 3));
    EXPECT_EQ(uv({"u", "s", "t"}).at(0), Point2(2, 3));
    EXPECT_EQ(uv({"v", "texture_u", "texture_v", "s"}).at(0), Point2(2, 3));
    for (const auto &names : {std::vector<std::string>{"u", "t"}, {"s", "v"}, {"texture_u", "texture_t"}, {"u"}})
        EXPECT_TRUE(uv(names).empty()) << names[0];
    EXPECT_TRUE(WithProperties({"nx", "ny"}).triangles.n.empty());
}

std::string WithLineEnds(std::string text, const std::string &end) {
    std::erase(text, '\r');
    for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size()) text.replace(at, 1, end);
    return text;
}

TEST(Ply, LinesMayEndLikeOnAnySystem) {
    for (const std::string end : {"\r", "\r\n"}) {
        CheckMesh(ParsePly(WithLineEnds(Ascii(), end), "a.ply"));
        const std::string binary = Binary(false), mark = "end_header\n";
        const size_t body = binary.find(mark) + mark.size();
        CheckMesh(ParsePly(WithLineEnds(binary.substr(0, body), end) + binary.substr(body), "b.ply"));
    }
    // The first byte of a body may be that of a line end.
    for (const std::string end : {"\n", "\r", "\r\n"}) {
        std::string s = WithLineEnds(
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\n"
            "property uchar y\nproperty uchar z\nelement face 1\n"
            "property list uchar uchar vertex_indices\nend_header\n",
            end);
        s += std::string("\n\r\0\1\0\0\0\1\0\3\0\1\2", 13);
        EXPECT_EQ(ParsePly(s, "b.ply").triangles.p.at(0), Point3(10, 13, 0));
    }
}

std::string PlyError(const std::string &content) {
    return MessageOf([&] { ParsePly(content, "bad.ply"); });
}

std::string Replaced(std::string s, const std::string &from, const std::string &to) {
    size_t at = s.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return s.replace(at, from.size(), to);
}

TEST(Ply, MistakesAreNamedWithTheirPlace) {
    ExpectWords(PlyError("solid\n"), {"not a PLY"});
    const struct {
        const char *from, *to;
        std::vector<std::string> words;
    } kMistakes[] = {{"ascii", "asci", {"line 2"}},
                     {"ascii 1.0", "ascii 2.0", {"line 2", "version 2.0"}},
                     {"ascii 1.0\n", "ascii 1.0\nformat ascii 1.0\n", {"line 3", "twice"}},
                     {"3 0 1 2 7", "-3 0 1 2 7", {"face 0", "\"vertex_indices\" has the length -3"}},
                     {"double s", "quad s", {"unknown type \"quad\""}},
                     {"end_header", "the_end", {"unknown header keyword"}},
                     {"float y", "float why", {"x, y and z"}},
                     {"vertex_indices", "vertex_index", {"\"vertex_index\""}},
                     {"3 0 1 2 7", "3 0 1 4 7", {"4 is out of range"}},
                     {"3 0 1 2 7", "3 0 -1 2 7", {"-1 is out of range"}},
                     {"3 0 1 2 7", "3 0 1 99999999999999999999 7", {"too large"}},
                     {"-2.5e-1", "1.0.5", {"1.0.5", "vertex 3", "line 23"}},
                     {"float y", "float x", {"line 6", "\"x\"", "twice", "\"vertex\""}},
                     {"int face_indices", "int vertex_indices", {"\"vertex_indices\"", "twice", "\"face\""}},
                     {"vertex 4", "vertex 0", {"no vertices"}},
                     {"vertex 4", "vertex 99999999999", {"too early"}}};
    for (const auto &[from, to, words] : kMistakes) ExpectWords(PlyError(Replaced(Ascii(), from, to)), words);
    ExpectWords(PlyError(WithLineEnds(Replaced(Ascii(), "-2.5e-1", "1.0.5"), "\r")), {"line 23"});
}

TEST(Ply, AnElementThatComesTwiceIsAnError) {
    // Three vertices with normals, then four without: the normal of the fourth must not be read beyond the end of the
    // array.
    const std::string twice =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nelement vertex 4\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 1 2 3\n";
    ExpectWords(PlyError(twice), {"line 10: element \"vertex\" is declared twice"});
}

TEST(Ply, SkippedListsHaveALength) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list char int vertex_indices\nproperty list char int more\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 ";
    EXPECT_EQ(PlyError(text + "1 5"), "");
    ExpectWords(PlyError(text + "-1"), {"\"more\" has the length -1"});
}

TEST(Ply, BytesAfterTheLastElementAreCounted) {
    EXPECT_EQ(ParsePly(Ascii() + " \r\n\n", "a.ply").surplusBytes, 0u);
    EXPECT_EQ(ParsePly(Ascii() + "1 2\n", "a.ply").surplusBytes, 4u);
    EXPECT_EQ(ParsePly(Binary(true) + std::string(3, '\0'), "b.ply").surplusBytes, 3u);
}

TEST(Ply, EveryTruncationIsAnError) {
    for (const std::string &whole : {Ascii(), Binary(false), Binary(true)})
        for (size_t n = 0; n + 2 < whole.size(); ++n) EXPECT_NE(PlyError(whole.substr(0, n)), "") << n;
}

TEST(Ply, PositionsMustBeFiniteFloats) {
    for (const char *bad : {"1e400", "-1e39", "inf", "nan"})
        ExpectWords(PlyError(Replaced(Ascii(), "-2.5e-1", bad)), {"line 23 (vertex 3): z is ", "finite"});
    EXPECT_EQ(PlyError(Replaced(Ascii(), "-2.5e-1", "1e-400")), "") << "numbers too small for a float become 0";
    EXPECT_EQ(ParsePly(Replaced(Ascii(), "-2.5e-1", "1e-400"), "x").triangles.p[3].z, 0);
    for (bool big : {false, true}) {
        std::string infinity, whole = Binary(big), z;
        Put(z, -0.25f, big);
        Put(infinity, std::numeric_limits<float>::infinity(), big);
        ExpectWords(PlyError(Replaced(whole, z, infinity)), {"vertex 3: z is inf"});
    }
}

TEST(Ply, NormalsAndUvThatAreNotFiniteAreZeroAndCounted) {
    const PlyMesh mesh = ParsePly(
        Replaced(Replaced(Ascii(), "0 0 0 0 0 1 0 0 255", "0 0 0 nan 0 1 0 0 255"), "0 0 1 1 1 1", "0 0 1 inf 1 1"),
        "x.ply");
    EXPECT_EQ(mesh.brokenAttributes, 2u);
    EXPECT_EQ(mesh.triangles.n[0], Normal3(0));
    EXPECT_EQ(mesh.triangles.uv[2], Point2(0));
    EXPECT_EQ(mesh.triangles.n[1], Normal3(0, 0, 1));
}

TEST(Ply, AnElementOfNothingTakesNoTime) {
    // Elements without properties have no size: any number of them fits into the file.
    const std::string text =
        Replaced(Ascii(), "element edge 1\nproperty int vertex1\n", "element edge 18000000000000000000\n");
    EXPECT_EQ(ParsePly(text.substr(0, text.size() - 2), "x.ply").triangles.indices.size(), 3u);
}

}  // namespace
}  // namespace pbrt::test
