"""joint_fit"""
