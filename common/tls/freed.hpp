// What OpenSSL made is freed with its owner: std::unique_ptr<X509, Freed<X509_free>>.
#pragma once

namespace trb {

template <auto kFree>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};

}  // namespace trb
