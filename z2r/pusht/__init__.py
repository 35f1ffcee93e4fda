"""PushT: the planar world that was recorded, a pusher that shoves a T-shaped block onto a target."""
