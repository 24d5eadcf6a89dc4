"""decay"""
