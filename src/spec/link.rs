//! How a vehicle is reached, as a spec and the command line write it.

use std::fmt;

use super::Link;

impl Link {
    /// What a link may be, for messages.
    pub const ALLOWED: &'static str = "sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT, \
         tcpin:HOST:PORT, serial:DEVICE:BAUD";

    /// Reads a link; `None` when it is of no known form.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        if text == "sim" {
            return Some(Self::Sim);
        }
        let (scheme, rest) = text.split_once(':')?;
        // MAVSDK writes `udpin://HOST:PORT` and `serial:///DEVICE:BAUD`.
        let rest = rest.strip_prefix("//").unwrap_or(rest);
        let (before, last) = rest.rsplit_once(':')?;
        let good = |c: char| !c.is_whitespace() && !c.is_control();
        if before.is_empty()
            || !before.chars().all(good)
            || !last.chars().all(|c| c.is_ascii_digit())
        {
            return None;
        }
        if scheme == "serial" {
            let baud = last.parse().ok().filter(|baud| *baud > 0)?;
            return Some(Self::Serial {
                device: before.to_owned(),
                baud,
            });
        }
        last.parse::<u16>().ok().filter(|port| *port > 0)?;
        // A host is a name, an IPv4 address, or an IPv6 address in brackets.
        let bracketed = before.starts_with('[') && before.ends_with(']');
        if before.contains([':', '/']) && !bracketed {
            return None;
        }
        match scheme {
            "udpout" => Some(Self::UdpOut(rest.to_owned())),
            "udpin" => Some(Self::UdpIn(rest.to_owned())),
            "tcp" => Some(Self::Tcp(rest.to_owned())),
            "tcpin" => Some(Self::TcpIn(rest.to_owned())),
            _ => None,
        }
    }
}

impl fmt::Display for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sim => f.write_str("sim"),
            Self::UdpOut(address) => write!(f, "udpout:{address}"),
            Self::UdpIn(address) => write!(f, "udpin:{address}"),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::TcpIn(address) => write!(f, "tcpin:{address}"),
            Self::Serial { device, baud } => write!(f, "serial:{device}:{baud}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Link;

    #[test]
    fn links_come_back_as_they_were_written() {
        for text in [
            "sim",
            "udpout:127.0.0.1:14550",
            "udpin:[::1]:14540",
            "tcp:host:5760",
            "tcpin:0.0.0.0:5760",
            "serial:/dev/ttyUSB0:57600",
        ] {
            assert_eq!(
                Link::parse(text).map(|link| link.to_string()).as_deref(),
                Some(text)
            );
        }
        for (written, meant) in [
            ("udpin://0.0.0.0:14540", "udpin:0.0.0.0:14540"),
            ("udpout://127.0.0.1:14550", "udpout:127.0.0.1:14550"),
            ("tcp://host:5760", "tcp:host:5760"),
            ("tcpin://0.0.0.0:5760", "tcpin:0.0.0.0:5760"),
            ("serial:///dev/ttyUSB0:57600", "serial:/dev/ttyUSB0:57600"),
        ] {
            assert_eq!(Link::parse(written), Link::parse(meant), "{written}");
            assert!(Link::parse(written).is_some(), "{written}");
        }
        for text in [
            "",
            "udpin://",
            "udpin:///host:1",
            "sim:",
            "udpout:host",
            "udpout::14550",
            "udpout:host:0",
            "udpout:a:b:1",
            "ftp:host:1",
            "tcp:ho st:1",
        ] {
            assert_eq!(Link::parse(text), None, "{text}");
        }
    }
}
