//! Motion-capture CSV bytes (Vicon Nexus and Workstation, Motive) to their own records.
