#include "common/config/hall_picture.hpp"

#include <doctest/doctest.h>

using namespace trb;

TEST_CASE("hall.svg: its edges are those of its viewBox, turned over, for in a picture y grows downwards") {
  for (const char* svg :
       {"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-2 -6 11 8\">", "<svg viewBox='-2,-6, 11 8'/>",
        "<?xml version=\"1.0\"?><!-- a hall -->\n<svg\n viewBox=\" -2 -6\n11 8 \" width=\"1\">"}) {
    const auto box = hall_box_of(svg);
    REQUIRE_MESSAGE(box, svg);
    CHECK(box->west == -2);
    CHECK(box->south == -2);
    CHECK(box->east == 9);
    CHECK(box->north == 6);
  }
}

TEST_CASE("hall.svg: what says nothing of metres is refused, with what to write") {
  for (const char* svg : {"", "not a picture", "<svg>", "<svg width=\"5\">", "<svg><g viewBox=\"0 0 1 1\"/></svg>",
                          "<svg viewBox=>", "<svg viewBox=\"0 0 1 1", "<svg viewBox=\"\">", "<svg viewBox=\"0 0 1\">",
                          "<svg viewBox=\"0 0 1 1 1\">", "<svg viewBox=\"0 0 a 1\">", "<svg viewBox=\"0 0 0 1\">",
                          "<svg viewBox=\"0 0 1 -1\">", "<svg viewBox=\"nan 0 1 1\">", "<svg viewBox=\"0 0 inf 1\">",
                          "<svg viewBox=\"1e300 0 1 1\">", "<svg viewBox=\"0 0 1000000 1\">"}) {
    const auto box = hall_box_of(svg);
    REQUIRE_MESSAGE(!box, svg);
    CHECK(box.error().hint.find("viewBox") != std::string::npos);
  }
}
