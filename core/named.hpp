// SPDX-License-Identifier: GPL-3.0-or-later
// Enumerations and the names of their values in manifests, records, tables and messages.
//
// Each enumeration has one table beside its definition:
//   template <>
//   inline constexpr auto kNames<Fluid> =
//       names_in_order<Fluid>("still", "cell");
// An enumerator without a name is a compile-time error.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace shearcell {

template <class Enum>
struct Named {
  Enum value;
  std::string_view name;
};

namespace named_detail {

/// Whether the enumeration has an enumerator of this value: only then does the compiler print its
/// name, as `V = shearcell::Fluid::cell` and not as `V = (shearcell::Fluid)2`.
template <auto V>
constexpr bool is_enumerator() {
  const std::string_view text = __PRETTY_FUNCTION__;
  return text[text.find("V = ") + 4] != '(';
}

}  // namespace named_detail

/// The table of an enumeration whose values are 0, 1, ..., from the names in that order.
template <class Enum, class... Names>
constexpr auto names_in_order(Names... names) {
  constexpr std::size_t size = sizeof...(Names);
  static_assert(named_detail::is_enumerator<static_cast<Enum>(size - 1)>(),
                "more names than values");
  static_assert(!named_detail::is_enumerator<static_cast<Enum>(size)>(), "a value without a name");
  std::size_t value = 0;
  return std::array<Named<Enum>, size>{Named<Enum>{static_cast<Enum>(value++), names}...};
}

/// Specialised for each enumeration that has names.
template <class Enum>
inline constexpr auto kNames = nullptr;

/// The names alone, in the order of the values.
template <class Enum>
inline constexpr auto kNameList = [] {
  std::array<std::string_view, kNames<Enum>.size()> list;
  std::ranges::transform(kNames<Enum>, list.begin(), &Named<Enum>::name);
  return list;
}();

template <class Enum>
constexpr std::string_view name_of(Enum value) {
  const auto& names = kNameList<Enum>;
  return names[static_cast<std::size_t>(value)];
}

/// Nothing when no value has that name.
template <class Enum>
constexpr std::optional<Enum> value_of(std::string_view name) {
  for (const Named<Enum>& entry : kNames<Enum>) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

}  // namespace shearcell
