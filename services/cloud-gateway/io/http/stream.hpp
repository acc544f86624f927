#pragma once
/// The sockets and their TLS as the gateway's connections have them.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>

namespace trb::gateway {

/// With the executor's own type: asking it costs nothing.
using Socket = boost::asio::basic_stream_socket<boost::asio::ip::tcp, boost::asio::io_context::executor_type>;
using Tls = boost::beast::ssl_stream<Socket>;
using Problem = boost::system::error_code;

}  // namespace trb::gateway
