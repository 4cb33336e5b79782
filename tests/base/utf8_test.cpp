#include "core/base/utf8.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace scree {
namespace {

TEST(utf8, any_bytes_come_back_from_json_as_they_were) {
  std::string all;
  for (int c = 1; c < 256; ++c) all += static_cast<char>(c);
  // a name in Latin-1; overlong, surrogate and cut-off forms; characters of the private range itself; valid text
  for (const std::string& bytes : {all, std::string("b\xe4ll"), std::string("\xc0\xaf \xed\xa0\x80 \xf4\x90\x80\x80 \xe2\x82"),
                                   std::string("\xef\x9f\xa4 \xef\x9e\x80"),
                                   std::string("gr\xc3\xb6\xc3\x9f"
                                               "e \xf0\x9f\xaa\xa8"),
                                   std::string()}) {
    const std::string text = utf8_from_bytes(bytes);
    EXPECT_EQ(bytes_from_utf8(text), bytes);
    const nlohmann::json back = nlohmann::json::parse(nlohmann::json(text).dump());  // throws when it is no UTF-8
    EXPECT_EQ(bytes_from_utf8(back.get<std::string>()), bytes);
  }
  EXPECT_EQ(utf8_from_bytes("gr\xc3\xb6\xc3\x9f"
                            "e"),
            "gr\xc3\xb6\xc3\x9f"
            "e");
}

TEST(utf8, people_read_bytes_as_numbers) {
  EXPECT_EQ(printable("b\xe4ll gr\xc3\xb6\xc3\x9f"
                      "er"),
            "b\\xE4ll gr\xc3\xb6\xc3\x9f"
            "er");
  EXPECT_EQ(printable(utf8_from_bytes("b\xe4ll")), "b\\xE4ll");
}

TEST(utf8, json_of_any_strings_is_text_and_valid_ones_stay) {
  const nlohmann::json value = {{"b\xe4ll",
                                 {"\xff",
                                  3,
                                  nullptr,
                                  {{"k",
                                    "gr\xc3\xb6\xc3\x9f"
                                    "e"}}}}};
  const nlohmann::json back = nlohmann::json::parse(json_text(value));
  const nlohmann::json& list = back[utf8_from_bytes("b\xe4ll")];
  EXPECT_EQ(bytes_from_utf8(list[0].get<std::string>()), "\xff");
  EXPECT_EQ(list[1], 3);
  EXPECT_EQ(list[3]["k"],
            "gr\xc3\xb6\xc3\x9f"
            "e");
  EXPECT_EQ(json_text({1, 2}, 1), nlohmann::json({1, 2}).dump(1));
}

}  // namespace
}  // namespace scree
