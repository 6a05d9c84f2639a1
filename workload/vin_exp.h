#pragma once
#include <cstdlib>
inline float vin(const char* name, float value) {
  const char* s = std::getenv(name);
  return s ? static_cast<float>(std::atof(s)) : value;
}
